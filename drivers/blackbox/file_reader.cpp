// SPDX-License-Identifier: MIT
#include "drivers/blackbox/file_reader.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace dampline::drivers {

BlackboxFileReader::Opened BlackboxFileReader::open(const char* path) noexcept {
  close();
  header_ = {};
  next_number_ = 0;
  damaged_ = 0;
  in_damage_ = false;
  torn_ = false;
  at_end_ = false;
  offset_ = 0;
  begin_ = 0;
  end_ = 0;
  file_ = ::open(path, O_RDONLY | O_CLOEXEC);
  error_number_ = file_ < 0 ? errno : 0;
  if (file_ < 0) return error_number_ == ENOENT ? Opened::kGone : Opened::kError;
  const Opened opened = read_header();
  if (opened != Opened::kOpen) close();
  return opened;
}

void BlackboxFileReader::close() noexcept {
  if (file_ >= 0) ::close(file_);
  file_ = -1;
}

BlackboxFileReader::Opened BlackboxFileReader::read_header() noexcept {
  if (!fill()) return Opened::kError;
  if (available().size() < kHeaderBytes) return Opened::kCutOff;
  HeaderFault fault = decode_header(available().first<kHeaderBytes>(), header_);
  const bool has_second = available().size() >= kRecordsAt;
  if (fault != HeaderFault::kNone && fault != HeaderFault::kOtherVersion && has_second) {
    fault = decode_header(available().subspan<kSecondHeaderAt, kHeaderBytes>(), header_);
  }
  if (fault == HeaderFault::kOtherVersion) return Opened::kOtherVersion;
  if (fault != HeaderFault::kNone) return Opened::kNoHeader;
  seed_ = header_.checksum_seed();
  in_damage_ = !has_second;
  begin_ = has_second ? kRecordsAt : end_;
  return Opened::kOpen;
}

// False: a read failed. Afterwards a whole record fits in what is available, or it is all there is.
bool BlackboxFileReader::fill() noexcept {
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  while (end_ < buffer_.size()) {
    const auto count = ::read(file_, buffer_.data() + end_, buffer_.size() - end_);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      error_number_ = errno;
      return false;
    }
    if (count == 0) {
      at_end_ = true;
      return true;
    }
    end_ += static_cast<std::size_t>(count);
    offset_ += static_cast<std::uint64_t>(count);
  }
  return true;
}

BlackboxFileReader::Status BlackboxFileReader::next(BlackboxRecord& record) noexcept {
  if (file_ < 0) return Status::kEnd;
  for (;;) {
    if (end_ - begin_ < kLongestRecord && !at_end_ && !fill()) return Status::kError;
    if (begin_ == end_) {
      torn_ = in_damage_;
      return Status::kEnd;
    }
    // A number that is not new is that of a copy, say in a block that the disk gave twice.
    if (decode_record(available(), seed_, record) && record.number >= next_number_) {
      take(record);
      return Status::kRecord;
    }
    skip_to_magic();
  }
}

void BlackboxFileReader::take(const BlackboxRecord& record) noexcept {
  if (in_damage_) ++damaged_;
  in_damage_ = false;
  next_number_ = std::uint64_t{record.number} + 1;
  begin_ += record.bytes();
}

void BlackboxFileReader::skip_to_magic() noexcept {
  in_damage_ = true;
  const std::uint8_t* const from = buffer_.data() + begin_ + 1;
  const void* found = std::memchr(from, kRecordMagic[0], end_ - begin_ - 1);
  begin_ = found == nullptr
               ? end_
               : static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - buffer_.data());
}

void BlackboxFileReader::skip_to_tail(std::uint64_t bytes) noexcept {
  const off_t size = ::lseek(file_, 0, SEEK_END);
  const auto wanted = static_cast<std::uint64_t>(size < 0 ? 0 : size);
  const std::uint64_t from = wanted > bytes + kRecordsAt ? wanted - bytes : kRecordsAt;
  if (size < 0 || ::lseek(file_, static_cast<off_t>(from), SEEK_SET) < 0) return;
  offset_ = from;
  begin_ = 0;
  end_ = 0;
  at_end_ = false;
}

}  // namespace dampline::drivers
