// SPDX-License-Identifier: MIT
#include "drivers/text/line_reader.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

namespace dampline::drivers {
namespace {

Failure cannot_open(const std::string& path, int error_number) {
  return {Errc::kIo, fmt::format("{}: cannot be opened: {}", path, std::strerror(error_number))};
}

}  // namespace

Outcome<LineReader> LineReader::open(const std::string& path) {
  const bool is_stdin = path == "-";
  // A file is opened without waiting for a writer; reading a named pipe polls first.
  const int descriptor = is_stdin ? ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0)
                                  : ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return cannot_open(path, errno);
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || S_ISDIR(status.st_mode)) {
    const int reason = S_ISDIR(status.st_mode) ? EISDIR : errno;
    ::close(descriptor);
    return cannot_open(path, reason);
  }
  const bool is_file = S_ISREG(status.st_mode);
  if (is_file) static_cast<void>(::posix_fadvise(descriptor, 0, 0, POSIX_FADV_SEQUENTIAL));
  return LineReader{is_stdin ? "standard input" : path, descriptor, !is_file};
}

LineReader::LineReader(std::string name, int descriptor, bool may_block)
    : name_{std::move(name)}, descriptor_{descriptor}, may_block_{may_block}, buffer_(kBuffer) {}

LineReader::LineReader(LineReader&& other) noexcept
    : name_{std::move(other.name_)},
      descriptor_{std::exchange(other.descriptor_, -1)},
      may_block_{other.may_block_},
      at_end_{other.at_end_},
      discarding_{other.discarding_},
      error_number_{other.error_number_},
      begin_{other.begin_},
      end_{other.end_},
      line_number_{other.line_number_},
      buffer_{std::move(other.buffer_)} {}

LineReader::~LineReader() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool LineReader::readable(int timeout_ms) const noexcept {
  pollfd request{descriptor_, POLLIN, 0};
  return ::poll(&request, 1, timeout_ms) > 0;
}

bool LineReader::wait(std::chrono::nanoseconds timeout) noexcept {
  if (!may_block_ || at_end_ || error_number_ != 0) return true;
  if (std::memchr(buffer_.data() + begin_, '\n', end_ - begin_) != nullptr) return true;
  const auto timeout_ms = std::chrono::ceil<std::chrono::milliseconds>(timeout).count();
  return readable(static_cast<int>(std::clamp<std::int64_t>(timeout_ms, 0, 1'000'000'000)));
}

// Moves what is left to the front and appends what can be read without waiting.
LineReader::Status LineReader::fill() noexcept {
  if (error_number_ != 0) return Status::kError;
  if (at_end_) return Status::kEnd;
  if (may_block_ && !readable(0)) return Status::kNothingYet;
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  const ssize_t count = ::read(descriptor_, buffer_.data() + end_, kBuffer - end_);
  if (count > 0) {
    end_ += static_cast<std::size_t>(count);
    return Status::kLine;
  }
  if (count < 0 && (errno == EINTR || errno == EAGAIN)) return Status::kNothingYet;
  if (count < 0) error_number_ = errno;
  at_end_ = true;
  return count < 0 ? Status::kError : Status::kEnd;
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
