// SPDX-License-Identifier: MIT
#include "drivers/blf/source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <string_view>
#include <utility>

#include "drivers/blf/object.hpp"
#include "drivers/bytes/little_endian.hpp"
#include "drivers/record/identifier.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::drivers {
namespace {

constexpr std::size_t kFileBuffer = std::size_t{64} * 1024;
constexpr std::size_t kObjectsBuffer = std::size_t{128} * 1024;
constexpr std::size_t kFileHeader = 72;  // up to the end of the two times
constexpr std::size_t kStartAt = 40;
constexpr std::size_t kLongestFileHeader = 4096;
constexpr std::size_t kMostPadding = 8;

std::string_view text_of(std::span<const char> bytes) { return {bytes.data(), bytes.size()}; }

}  // namespace

Outcome<std::unique_ptr<RecordedFrames>> BlfSource::open(const FrameFileConfig& config) {
  Outcome<ByteStream> stream = ByteStream::open(config.path);
  if (!stream.ok()) return stream.failure();
  std::unique_ptr<BlfSource> out{new BlfSource{config, std::move(stream.value())}};
  if (out->inflate_ == nullptr)
    return Failure{Errc::kIo, fmt::format("{}: no memory to decompress it", config.path)};
  return std::unique_ptr<RecordedFrames>{std::move(out)};
}

BlfSource::BlfSource(const FrameFileConfig& config, ByteStream stream)
    : RecordedFrames{config},
      file_{std::move(stream), kFileBuffer},
      inflate_{make_zlib()},
      objects_(kObjectsBuffer) {}

BlfSource::Status BlfSource::take_file_header() noexcept {
  if (header_taken_) return Status::kBytes;
  if (const Status status = file_.need(kFileHeader); status != Status::kBytes) return status;
  const std::size_t size = std::clamp<std::size_t>(little<std::uint32_t>(file_.bytes().data() + 4),
                                                   kFileHeader, kLongestFileHeader);
  if (const Status status = file_.need(size); status != Status::kBytes) return status;
  start_ns_ = read_system_time(file_.bytes().subspan(kStartAt));
  file_.drop(size);
  header_taken_ = true;
  return Status::kBytes;
}

// The next object of the file itself: a container, or one that has none and is its own.
BlfSource::Status BlfSource::begin_container() noexcept {
  if (const Status status = take_file_header(); status != Status::kBytes) return status;
  for (std::size_t padding = 0;;) {
    const Status status = file_.need(kBlfContainerHeader);
    if (status != Status::kBytes) {
      const auto rest = file_.bytes();
      const bool only_padding = status == Status::kEnd && rest.size() < kMostPadding &&
                                text_of(rest).find_first_not_of('\0') == std::string_view::npos;
      if (status == Status::kEnd && !only_padding) health_.truncated = true;
      return status;
    }
    container_at_ = file_.offset();
    const auto base = read_blf_base(file_.bytes());
    if (base && (base->type != kBlfContainer || base->size >= kBlfContainerHeader)) {
      compressed_ = false;
      container_left_ = base->size;
      if (base->type != kBlfContainer) return Status::kBytes;
      const auto method = little<std::uint16_t>(file_.bytes().data() + kBlfBaseHeader);
      compressed_ = method == 2;
      damaged_ = method != 0 && method != 2;
      container_left_ -= kBlfContainerHeader;
      file_.drop(kBlfContainerHeader);
      inflate_->restart();
      return Status::kBytes;
    }
    if (++padding > kMostPadding) {
      if (!std::exchange(damaged_, true)) return Status::kError;
      padding = kMostPadding;  // the error was reported: on to the next object
    }
    file_.drop(1);
  }
}

// Moves what is left to the front and appends some more of the containers' content.
BlfSource::Status BlfSource::fill_objects() noexcept {
  std::memmove(objects_.data(), objects_.data() + objects_begin_, objects_end_ - objects_begin_);
  objects_end_ -= objects_begin_;
  objects_begin_ = 0;
  for (;;) {
    if (container_left_ == 0) {
      damaged_ = false;
      const Status status = begin_container();
      if (status != Status::kBytes) return status;
      if (damaged_) return Status::kError;
      continue;
    }
    if (const Status status = file_.need(1); status != Status::kBytes) {
      if (status == Status::kEnd) health_.truncated = true;
      return status;
    }
    const auto some = file_.bytes().first(
        static_cast<std::size_t>(std::min<std::uint64_t>(file_.bytes().size(), container_left_)));
    const auto room = std::span{objects_}.subspan(objects_end_);
    Decompressor::Step step{std::min(some.size(), room.size()), 0, nullptr};
    if (damaged_) {
      step.taken = some.size();  // known as such: passed over
    } else if (compressed_) {
      step = inflate_->is_whole() ? Decompressor::Step{some.size(), 0, nullptr}
                                  : inflate_->push(some, room);
    } else {
      std::memcpy(room.data(), some.data(), step.taken);
      step.given = step.taken;
    }
    file_.drop(step.taken);
    container_left_ -= step.taken;
    objects_end_ += step.given;
    if (step.fault != nullptr) {
      damaged_ = true;
      return Status::kError;
    }
    if (step.given > 0) return Status::kBytes;
  }
}

BlfSource::Status BlfSource::need_objects(std::size_t count) noexcept {
  while (objects().size() < count)
    if (const Status status = fill_objects(); status != Status::kBytes) return status;
  return Status::kBytes;
}

BlfSource::Step BlfSource::read_one(CanFrame& frame) noexcept {
  while (skip_left_ > 0) {
    if (const Status status = need_objects(1); status != Status::kBytes) return end(status);
    const std::uint64_t some = std::min<std::uint64_t>(skip_left_, objects().size());
    objects_begin_ += static_cast<std::size_t>(some);
    skip_left_ -= some;
  }
  if (const Status status = need_objects(kBlfBaseHeader); status != Status::kBytes)
    return end(status);
  for (std::size_t padding = 0; padding <= kMostPadding; ++padding) {
    if (const Status status = need_objects(padding + kBlfBaseHeader); status != Status::kBytes)
      return end(status);
    if (!read_blf_base(objects().subspan(padding))) continue;
    objects_begin_ += padding;
    searching_ = false;
    return take_object(frame);
  }
  return no_object();
}

BlfSource::Step BlfSource::take_object(CanFrame& frame) noexcept {
  const BlfBase base = *read_blf_base(objects());
  const std::size_t head = std::min<std::size_t>(base.size, kBlfObjectHead);
  if (const Status status = need_objects(head); status != Status::kBytes) return end(status);
  std::uint32_t channel = 0;
  const BlfKind kind = read_blf_object(objects().first(head), frame, channel);
  if (kind == BlfKind::kBad) return no_object();
  objects_begin_ += head;
  skip_left_ = base.size - head;
  if (kind == BlfKind::kFrame) return deliver(frame, channel);
  ++health_.ignored;
  return Step::kNoFrame;
}

BlfSource::Step BlfSource::deliver(CanFrame& frame, std::uint32_t channel) noexcept {
  ChannelName name;
  const std::string_view interface = name.set(channel);
  const auto index = interfaces_.index_of(interface);
  if (!is_wanted(interface) || !index) {
    ++health_.ignored;
    return Step::kNoFrame;
  }
  frame.interface_index = *index;
  frame.time_ns += start_ns_;
  if (gate_.pass(frame.time_ns, health_)) return Step::kFrame;
  ++health_.malformed;
  if (skip_bad_lines_) return Step::kNoFrame;
  return stop(
      Errc::kMalformed,
      fmt::format("{}: in the container at byte {}: found a time that goes back by a second "
                  "or more",
                  file_.stream().name(), container_at_));
}

// Bytes that are no object: on to the next LOBJ, where that is wished.
BlfSource::Step BlfSource::no_object() noexcept {
  if (!searching_) ++health_.malformed;
  searching_ = true;
  if (!skip_bad_lines_)
    return stop(Errc::kMalformed,
                fmt::format("{}: in the container at byte {}: found {}, expected an object (LOBJ)",
                            file_.stream().name(), container_at_,
                            quote(text_of(objects()).substr(0, kBlfBaseHeader))));
  const std::size_t next = text_of(objects()).find("LOBJ", 1);
  const std::size_t rest = objects().size() - std::min<std::size_t>(objects().size(), 3);
  objects_begin_ += next == std::string_view::npos ? std::max<std::size_t>(rest, 1) : next;
  return Step::kNoFrame;
}

BlfSource::Step BlfSource::end(Status status) noexcept {
  if (status == Status::kNothingYet) return Step::kWait;
  if (status == Status::kError && damaged_) {
    ++health_.malformed;
    if (skip_bad_lines_) {
      objects_begin_ = objects_end_;
      skip_left_ = 0;
      return Step::kNoFrame;
    }
    return stop(
        Errc::kMalformed,
        fmt::format("{}: the container at byte {} is damaged, expected one of LOBJ with zlib "
                    "data or plain ones",
                    file_.stream().name(), container_at_));
  }
  if (status == Status::kError) return stop(file_.stream().error(), file_.stream().error_text());
  const bool rest = skip_left_ > 0 || objects().size() >= kMostPadding;
  health_.truncated = health_.truncated || rest || file_.stream().is_cut_off();
  if (!header_taken_)
    return stop(Errc::kMalformed, fmt::format("{}: ends within its header", file_.stream().name()));
  return stop(Errc::kEndOfStream, {});
}

}  // namespace dampline::drivers
