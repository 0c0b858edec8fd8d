// SPDX-License-Identifier: MIT
#include "drivers/text/line_reader.hpp"

#include <utility>

namespace dampline::drivers {

Outcome<LineReader> LineReader::open(const std::string& path) {
  Outcome<ByteStream> stream = ByteStream::open(path);
  if (!stream.ok()) return stream.failure();
  return LineReader{std::move(stream.value())};
}

bool LineReader::wait(std::chrono::nanoseconds timeout) noexcept {
  if (at_end_ || failed_) return true;
  if (std::memchr(buffer_.data() + begin_, '\n', end_ - begin_) != nullptr) return true;
  return stream_.wait(timeout);
}

// Moves what is left to the front and appends what can be read without waiting.
LineReader::Status LineReader::fill() noexcept {
  if (failed_) return Status::kError;
  if (at_end_) return Status::kEnd;
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  const ByteStream::Read part = stream_.read({buffer_.data() + end_, kBuffer - end_});
  end_ += part.count;
  switch (part.status) {
    case ByteStream::Status::kBytes:
      return Status::kLine;
    case ByteStream::Status::kNothingYet:
      return Status::kNothingYet;
    case ByteStream::Status::kEnd:
      at_end_ = true;
      return Status::kEnd;
    case ByteStream::Status::kError:
      break;
  }
  failed_ = true;
  return Status::kError;
}

LineReader::Status LineReader::next_slowly(std::string_view& line) noexcept {
  for (;;) {
    const char* begin = buffer_.data() + begin_;
    const auto* newline = static_cast<const char*>(std::memchr(begin, '\n', end_ - begin_));
    if (newline != nullptr) {
      line = cut(begin, static_cast<std::size_t>(newline - begin));
      if (!std::exchange(discarding_, false)) return Status::kLine;
      --line_number_;  // the end of the line that was counted when its beginning was given
      continue;
    }
    if (discarding_) begin_ = end_;
    if (end_ - begin_ > kLongestLine) {
      line = {begin, kLongestLine};
      begin_ = end_;
      ++line_number_;
      discarding_ = true;
      return Status::kTooLong;
    }
    const Status status = fill();
    if (status == Status::kLine) continue;
    if (status != Status::kEnd || begin_ == end_) return status;
    line = cut(buffer_.data() + begin_, end_ - begin_);
    begin_ = end_;
    return Status::kTail;
  }
}

std::string_view LineReader::peek() noexcept {
  while (end_ - begin_ < kLongestLine && fill() == Status::kLine) {
  }
  return {buffer_.data() + begin_, end_ - begin_};
}

}  // namespace dampline::drivers
