// SPDX-License-Identifier: MIT
#include "drivers/mdf/data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "drivers/compressed/decompressor.hpp"

namespace dampline::drivers {
namespace {

constexpr std::size_t kBuffer = 2 * MdfData::kLongest;
constexpr std::size_t kPacked = std::size_t{32} * 1024;

}  // namespace

MdfData::MdfData(std::shared_ptr<RandomFile> file, MdfLink at, bool open_ended)
    : file_{std::move(file)}, open_ended_{open_ended}, first_{at}, buffer_(kBuffer) {}

std::span<const char> MdfData::look(std::size_t count) noexcept {
  while (end_ - begin_ < count && fill()) {
  }
  return std::span{buffer_}.subspan(begin_, std::min(count, end_ - begin_));
}

bool MdfData::skip(std::uint64_t count) noexcept {
  for (;;) {
    const std::size_t some = std::min<std::uint64_t>(count, end_ - begin_);
    begin_ += some;
    count -= some;
    if (count == 0) return true;
    if (!fill()) return false;
  }
}

bool MdfData::fill() noexcept {
  if (!fault_.empty()) return false;
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  const auto room = std::span{buffer_}.subspan(end_);
  for (;;) {
    const std::size_t count = give(room);
    end_ += count;
    if (count > 0) return true;
    if (!fault_.empty() || !next_block()) return false;
  }
}

// Of the piece that is open; 0: nothing is left of it.
std::size_t MdfData::give(std::span<char> room) noexcept {
  if (transposed_at_ < transposed_.size()) {
    const std::size_t count = std::min(room.size(), transposed_.size() - transposed_at_);
    const std::size_t rows = transposed_.size() / transposed_columns_;
    const std::size_t whole = rows * transposed_columns_;
    for (std::size_t i = 0; i < count; ++i, ++transposed_at_)
      room[i] = transposed_at_ < whole ? transposed_[transposed_at_ % transposed_columns_ * rows +
                                                     transposed_at_ / transposed_columns_]
                                       : transposed_[transposed_at_];
    return count;
  }
  if (deflated_) return inflated(room);
  const std::size_t wanted = std::min<std::uint64_t>(room.size(), raw_left_);
  const std::size_t count = file_->read(raw_next_, room.first(wanted));
  raw_next_ += count;
  raw_left_ -= count;
  if (count < wanted) raw_left_ = 0;  // the file ends
  return count;
}

std::size_t MdfData::inflated(std::span<char> room) noexcept {
  room = room.first(std::min<std::uint64_t>(room.size(), inflated_left_));
  while (!room.empty()) {
    if (packed_begin_ == packed_end_) {
      packed_begin_ = 0;
      packed_end_ = file_->read(
          raw_next_, std::span{packed_}.first(std::min<std::uint64_t>(kPacked, raw_left_)));
      raw_next_ += packed_end_;
      raw_left_ -= packed_end_;
    }
    const auto step = inflate_->push(
        std::span{packed_}.subspan(packed_begin_, packed_end_ - packed_begin_), room);
    packed_begin_ += step.taken;
    inflated_left_ -= step.given;
    if (step.given > 0) return step.given;
    const bool ends = inflate_->is_whole() || packed_end_ == 0;
    if (step.fault == nullptr && !ends) continue;
    inflated_left_ = 0;
    if (step.fault == nullptr && cut_off_) return 0;
    fail(block_, "its deflated data are damaged or less than it says");
    return 0;
  }
  return 0;
}

bool MdfData::next_block() noexcept {
  deflated_ = false;
  raw_left_ = 0;
  if (cut_off_) return false;
  if (const MdfLink first = std::exchange(first_, 0); first != 0) {
    const auto head = read_mdf_head(*file_, first);
    if (!head) return fail(first, "expected a block of data");
    const bool header = head->is("HL");
    if (!header && !head->is("DL") && !head->is("LD")) return open_block(*head);
    if (!open_list(header ? read_mdf_link(*file_, *head, 0) : first)) return false;
  }
  while (entries_ > 0) {
    while (entry_ < entries_) {
      const MdfLink at = read_mdf_link(*file_, list_, 1 + entry_++);
      if (at == 0) continue;  // kept free by who wrote it
      const auto head = read_mdf_head(*file_, at);
      return head ? open_block(*head) : fail(at, "expected a block of data");
    }
    const MdfLink next = read_mdf_link(*file_, list_, 0);
    entries_ = 0;
    if (next != 0 && !open_list(next)) return false;
  }
  return false;
}

bool MdfData::open_list(MdfLink at) noexcept {
  const auto head = at == 0 ? std::nullopt : read_mdf_head(*file_, at);
  if (!head || !(head->is("DL") || head->is("LD")) || head->links < 1 || head->data_bytes() < 8)
    return fail(at, "expected a list of data blocks");
  std::array<char, 8> bytes{};
  if (!visit(*head) || file_->read(head->data_at(), bytes) < bytes.size())
    return fail(at, "ends within a list of data blocks");
  const std::uint64_t count = little<std::uint32_t>(bytes.data() + 4);
  if (count > head->links - 1) return fail(at, "a list of data blocks has fewer than it says");
  if (at == marked_) return fail(at, "the lists of data blocks lead in a circle");
  if ((lists_ & (lists_ - 1)) == 0) marked_ = at;  // after 1, 2, 4, ... of them: Brent
  ++lists_;
  list_ = *head;
  entry_ = 0;
  entries_ = count;
  return true;
}

// Blocks do not overlap: who reads more of them than the file has goes round in a circle.
bool MdfData::visit(const MdfHead& head) noexcept {
  visited_ += std::min(head.length, file_->size() - head.at);
  return visited_ <= file_->size() || fail(head.at, "the lists of data blocks lead in a circle");
}

bool MdfData::open_block(const MdfHead& head) noexcept {
  if (!visit(head)) return false;
  block_ = head.at;
  if (head.is("DZ")) return open_deflated(head);
  if (!head.is("DT") && !head.is("SD") && !head.is("DV"))
    return fail(head.at, "expected data (DT, DV, SD, DZ)");
  values_ = head.is("DV");
  const bool to_the_end = open_ended_ && head.data_bytes() == 0;
  raw_next_ = head.data_at();
  const std::uint64_t there = file_->size() - std::min(file_->size(), raw_next_);
  cut_off_ = !to_the_end && head.data_bytes() > there;
  raw_left_ = to_the_end ? there : std::min(there, head.data_bytes());
  return true;
}

bool MdfData::open_deflated(const MdfHead& head) noexcept {
  constexpr std::size_t kFields = 24;
  std::array<char, kFields> bytes{};
  if (head.data_bytes() < kFields || file_->read(head.data_at(), bytes) < kFields)
    return fail(head.at, "ends within the head of deflated data");
  const std::string_view original{bytes.data(), 2};
  const auto method = little<std::uint8_t>(bytes.data() + 2);
  const auto columns = little<std::uint32_t>(bytes.data() + 4);
  inflated_left_ = little<std::uint64_t>(bytes.data() + 8);
  raw_left_ = little<std::uint64_t>(bytes.data() + 16);
  raw_next_ = head.data_at() + kFields;
  if (original != "DT" && original != "SD" && original != "DV")
    return fail(head.at, "expected deflated data of DT, DV or SD");
  values_ = original == "DV";
  if (method > 1) return fail(head.at, "is compressed in another way than deflate");
  if (raw_left_ > head.data_bytes() - kFields || inflated_left_ / kMostDeflation > raw_left_)
    return fail(head.at, "its deflated data are damaged or less than it says");
  const std::uint64_t there = file_->size() - std::min(file_->size(), raw_next_);
  cut_off_ = raw_left_ > there;
  raw_left_ = std::min(raw_left_, there);
  if (!inflate_) inflate_ = make_zlib();
  if (!inflate_) return fail(head.at, "no memory to decompress it");
  inflate_->restart();
  packed_.resize(kPacked);
  packed_begin_ = packed_end_ = 0;
  deflated_ = true;
  return method == 0 || transpose(columns);
}

bool MdfData::transpose(std::uint32_t columns) noexcept {
  if (columns == 0 || inflated_left_ > kMostTransposed)
    return fail(block_, "is transposed without columns, or more than 64 MiB");
  if (cut_off_) {
    deflated_ = false;  // nothing of it can be told
    raw_left_ = 0;
    return true;
  }
  transposed_.resize(static_cast<std::size_t>(inflated_left_));
  for (std::size_t done = 0; done < transposed_.size();) {
    const std::size_t count = inflated(std::span{transposed_}.subspan(done));
    if (count == 0) {
      transposed_.clear();
      return false;
    }
    done += count;
  }
  deflated_ = false;
  transposed_at_ = 0;
  transposed_columns_ = columns;
  return true;
}

bool MdfData::fail(MdfLink at, const char* what) noexcept {
  if (fault_.empty()) fault_ = fmt::format("at byte {}: {}", at, what);
  return false;
}

}  // namespace dampline::drivers
