// SPDX-License-Identifier: MIT
#include "drivers/blackbox/source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <system_error>
#include <utility>

#include "drivers/blackbox/shelf.hpp"

namespace dampline::drivers {
namespace {

using Opened = BlackboxFileReader::Opened;
constexpr std::string_view kUnknownInterface = "unknown";

Outcome<std::vector<std::string>> paths_of(const std::filesystem::path& path) {
  std::error_code error;
  const auto fail = [&](Errc code, const std::string& what) {
    return Failure{code, fmt::format("{}: {}", path.string(), what)};
  };
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::none)
    return fail(Errc::kIo, "cannot be read: " + error.message());
  if (!std::filesystem::exists(status))
    return fail(Errc::kIo, "no such file or directory, expected a black box");
  if (std::filesystem::is_regular_file(status)) return std::vector{path.string()};
  if (!std::filesystem::is_directory(status))
    return fail(Errc::kMalformed, "is neither a directory nor a file, expected a black box");
  std::vector<std::string> paths;
  for (const BlackboxEntry& file : list_blackbox(path, error)) paths.push_back(file.path.string());
  if (error) return fail(Errc::kIo, "cannot be listed: " + error.message());
  if (paths.empty())
    return fail(Errc::kMalformed,
                "holds no black box file, expected names such as " + blackbox_file_name(1));
  return paths;
}

std::string found_text(Opened opened, const BlackboxFileReader& reader) {
  switch (opened) {
    case Opened::kOpen:
      break;
    case Opened::kGone:
      return "is gone";
    case Opened::kCutOff:
      return "is cut off in its header";
    case Opened::kNoHeader:
      return "has no header of a black box file";
    case Opened::kOtherVersion:
      return fmt::format("is of format version {}, expected {}", reader.header().version,
                         kBlackboxVersion);
    case Opened::kError:
      return "cannot be read: " + std::generic_category().message(reader.error_number());
  }
  return "can be read";
}

}  // namespace

Outcome<std::unique_ptr<BlackboxSource>> BlackboxSource::open(const BlackboxSourceConfig& config) {
  auto paths = paths_of(config.path);
  if (!paths.ok()) return paths.failure();
  std::unique_ptr<BlackboxSource> source{new BlackboxSource{config, std::move(paths.value())}};
  const auto looked = source->look_at_files();
  if (!looked.ok()) return looked.failure();
  return source;
}

BlackboxSource::BlackboxSource(const BlackboxSourceConfig& config, std::vector<std::string> paths)
    : paths_{std::move(paths)}, wanted_{config.interfaces} {}

/// How many files can be read; also learns the names of all interfaces.
Outcome<std::uint64_t> BlackboxSource::look_at_files() {
  std::uint64_t readable = 0;
  std::string first_fault;
  for (const std::string& path : paths_) {
    const Opened opened = reader_.open(path.c_str());
    const std::string text = fmt::format("{}: {}", path, found_text(opened, reader_));
    if (opened == Opened::kOtherVersion) return Failure{Errc::kMismatch, text};
    if (opened == Opened::kError) return Failure{Errc::kIo, text};
    if (opened != Opened::kOpen && first_fault.empty()) first_fault = text;
    if (opened != Opened::kOpen) continue;
    ++readable;
    for (std::size_t i = 0; i < reader_.header().interface_count; ++i) {
      if (interfaces_.index_of(reader_.header().interface_name(i))) continue;
      return Failure{Errc::kMalformed, fmt::format("{}: more than {} interfaces in all", path,
                                                   InterfaceTable::kMost)};
    }
  }
  reader_.close();
  if (readable == 0) return Failure{Errc::kMalformed, first_fault};
  return readable;
}

Result<std::size_t> BlackboxSource::do_read(std::span<CanFrame> out) noexcept {
  if (out.empty()) return std::size_t{0};
  has_event_ = false;
  std::size_t count = 0;
  Step last = Step::kNothing;
  while (count < out.size() && last != Step::kStop && last != Step::kEvent) {
    last = step(out[count]);
    if (last == Step::kFrame) ++count;
  }
  health_.frames += count;
  if (count == 0 && last == Step::kStop) return reason_;
  return count;
}

bool BlackboxSource::do_next_event(hal::Event& out) noexcept {
  if (!std::exchange(has_event_, false)) return false;
  out = event_;
  return true;
}

BlackboxSource::Step BlackboxSource::step(CanFrame& frame) noexcept {
  if (stopped_) return Step::kStop;
  if (!reading_) return next_file();
  BlackboxRecord record;
  switch (reader_.next(record)) {
    case BlackboxFileReader::Status::kRecord:
      return take(record, frame);
    case BlackboxFileReader::Status::kEnd:
      end_file();
      return Step::kNothing;
    case BlackboxFileReader::Status::kError:
      break;
  }
  return stop(Errc::kIo, fmt::format("{}: cannot be read at byte {}: {}", paths_[next_path_ - 1],
                                     reader_.offset(),
                                     std::generic_category().message(reader_.error_number())));
}

BlackboxSource::Step BlackboxSource::next_file() noexcept {
  if (next_path_ == paths_.size()) return stop(Errc::kEndOfStream, {});
  const std::string& path = paths_[next_path_++];
  const Opened opened = reader_.open(path.c_str());
  if (opened == Opened::kError || opened == Opened::kOtherVersion) {
    return stop(opened == Opened::kError ? Errc::kIo : Errc::kMismatch,
                fmt::format("{}: {}", path, found_text(opened, reader_)));
  }
  reading_ = opened == Opened::kOpen;
  if (reading_) {
    use_header(reader_.header());
  } else if (opened == Opened::kCutOff) {
    ++findings_.torn_ends;
    health_.truncated = next_path_ == paths_.size();
  } else {
    ++findings_.unreadable_files;
    ++health_.malformed;
  }
  return Step::kNothing;
}

void BlackboxSource::use_header(const BlackboxHeader& header) noexcept {
  ++findings_.files;
  if (!any_file_) next_sequence_ = header.first_sequence - header.missing_before;
  if (!any_file_ || run_id_ != header.run_id) {
    run_id_ = header.run_id;
    placed_ = false;
    moved_ns_ = 0;
  }
  any_file_ = true;
  expect(header.first_sequence);
  for (std::size_t i = 0; i < index_of_.size(); ++i) {
    const bool named = i < header.interface_count;
    const std::string_view name = named ? header.interface_name(i) : kUnknownInterface;
    is_wanted_[i] = wanted(name);
    if (named) index_of_[i] = interfaces_.index_of(name).value_or(0);
  }
}

bool BlackboxSource::wanted(std::string_view interface) const noexcept {
  return wanted_.empty() || std::find(wanted_.begin(), wanted_.end(), interface) != wanted_.end();
}

void BlackboxSource::end_file() noexcept {
  reading_ = false;
  findings_.damaged_stretches += reader_.damaged_stretches();
  health_.malformed += reader_.damaged_stretches();
  if (reader_.torn()) ++findings_.torn_ends;
  health_.truncated = reader_.torn() && next_path_ == paths_.size();
  reader_.close();
}

/// The next record has this number; those between are missing.
void BlackboxSource::expect(std::uint64_t sequence) noexcept {
  if (sequence > next_sequence_) {
    findings_.missing += sequence - next_sequence_;
    health_.dropped += sequence - next_sequence_;
  }
  next_sequence_ = sequence;
}

BlackboxSource::Step BlackboxSource::take(const BlackboxRecord& record, CanFrame& frame) noexcept {
  expect(reader_.header().first_sequence + record.number);
  ++next_sequence_;
  hal::Event event;
  if (decode_frame(record, frame)) return take_frame(frame);
  if (decode_event(record, event)) return take_event(event);
  ++findings_.unknown;
  ++health_.ignored;
  return Step::kNothing;
}

BlackboxSource::Step BlackboxSource::take_frame(CanFrame& frame) noexcept {
  const std::size_t index = frame.interface_index;
  if (!is_wanted_[index]) {
    ++health_.ignored;
    return Step::kNothing;
  }
  if (index >= reader_.header().interface_count)
    index_of_[index] = interfaces_.index_of(kUnknownInterface).value_or(0);
  frame.interface_index = index_of_[index];
  place(frame.time_ns);
  if (findings_.any_frame() && frame.time_ns < findings_.newest_ns) {
    ++health_.reordered;
    frame.time_ns = findings_.newest_ns;
  }
  if (!findings_.any_frame()) findings_.first_ns = frame.time_ns;
  ++findings_.frames;
  findings_.newest_ns = frame.time_ns;
  if (frame.error) ++health_.error_frames;
  if (frame.time_source == TimeSource::kHardware) ++health_.hardware_times;
  return Step::kFrame;
}

namespace {

/// Times of a damaged or hostile file stop at the ends of the clock.
std::int64_t sum_of(std::int64_t a, std::int64_t b) noexcept {
  std::int64_t sum = 0;
  if (!__builtin_add_overflow(a, b, &sum)) return sum;
  return b > 0 ? std::numeric_limits<std::int64_t>::max()
               : std::numeric_limits<std::int64_t>::min();
}

}  // namespace

/// Where a run begins earlier than the one before had ended, all of it is moved.
void BlackboxSource::place(std::int64_t& time_ns) noexcept {
  if (!std::exchange(placed_, true) && any_time_ && time_ns < newest_ns_) {
    if (__builtin_sub_overflow(newest_ns_, time_ns, &moved_ns_)) moved_ns_ = newest_ns_;
    ++findings_.runs_moved;
  }
  time_ns = sum_of(time_ns, moved_ns_);
  newest_ns_ = any_time_ ? std::max(newest_ns_, time_ns) : time_ns;
  any_time_ = true;
}

BlackboxSource::Step BlackboxSource::take_event(hal::Event event) noexcept {
  place(event.time_ns);
  ++findings_.events;
  restore(event);
  event_ = event;
  has_event_ = true;
  return Step::kEvent;
}

/// What the live source counted when this happened.
void BlackboxSource::restore(const hal::Event& event) noexcept {
  using Kind = hal::EventKind;
  const auto value = static_cast<std::uint64_t>(std::max<std::int64_t>(event.value, 0));
  if (event.kind == Kind::kLinkDown) ++health_.link_downs;
  if (event.kind == Kind::kInterfaceBack) ++health_.reopened;
  if (event.kind == Kind::kBusOff) ++health_.bus_offs;
  if (event.kind == Kind::kBusRestarted) ++health_.restarts;
  if (event.kind == Kind::kClockStep) ++health_.clock_steps;
  if (event.kind == Kind::kFramesDropped || event.kind == Kind::kRecordsLost)
    health_.dropped += value;
  if (event.kind == Kind::kLinkDown) health_.link_up = false;
  if (event.kind == Kind::kLinkUp || event.kind == Kind::kRunStart) health_.link_up = true;
}

BlackboxSource::Step BlackboxSource::stop(Errc reason, std::string text) noexcept {
  stopped_ = true;
  reason_ = reason;
  error_ = std::move(text);
  reader_.close();
  return Step::kStop;
}

}  // namespace dampline::drivers
