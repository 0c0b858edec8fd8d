// SPDX-License-Identifier: MIT
#pragma once
#include <chrono>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/bytes/byte_stream.hpp"
#include "drivers/outcome.hpp"

namespace dampline::drivers {

/// Lines of a text file or of standard input, decompressed where they are gzip or zstd, through one
/// fixed buffer, whatever the file's size.
/// Never waits: a pipe that has nothing yet gives kNothingYet.
class LineReader {
 public:
  static constexpr std::size_t kBuffer = std::size_t{256} * 1024;
  static constexpr std::size_t kLongestLine = std::size_t{64} * 1024;

  enum class Status : std::uint8_t {
    kLine,        ///< a line that ended with \n; the \n and a \r before it are cut off
    kTail,        ///< the file's last bytes, without \n: it was cut off, or written carelessly
    kTooLong,     ///< a line above kLongestLine; its beginning is given, the rest is skipped
    kNothingYet,  ///< a pipe is open but empty
    kEnd,
    kError,  ///< error() and error_text() say why
  };

  /// path "-" is standard input.
  static Outcome<LineReader> open(const std::string& path);
  LineReader(LineReader&& other) noexcept = default;
  LineReader& operator=(LineReader&&) = delete;
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;
  ~LineReader() = default;

  /// The view is good until the next call of next() or peek().
  Status next(std::string_view& line) noexcept {
    const char* begin = buffer_.data() + begin_;
    const auto* newline = static_cast<const char*>(std::memchr(begin, '\n', end_ - begin_));
    if (newline == nullptr || discarding_) return next_slowly(line);
    line = cut(begin, static_cast<std::size_t>(newline - begin));
    return Status::kLine;
  }
  /// What follows the line given last, as far as it can be had at once: up to kLongestLine bytes.
  std::string_view peek() noexcept;
  /// True when next() will give something, or the end.
  bool wait(std::chrono::nanoseconds timeout) noexcept;

  [[nodiscard]] std::uint64_t line_number() const noexcept { return line_number_; }
  [[nodiscard]] const std::string& name() const noexcept { return stream_.name(); }
  [[nodiscard]] Errc error() const noexcept { return stream_.error(); }
  /// With the file's name.
  [[nodiscard]] std::string error_text() const { return stream_.error_text(); }
  /// At the end: compressed data stopped in the middle.
  [[nodiscard]] bool is_cut_off() const noexcept { return stream_.is_cut_off(); }
  /// Of the file as it lies there, 0...1; none of a pipe.
  [[nodiscard]] std::optional<double> share_read() const noexcept { return stream_.share_read(); }

 private:
  explicit LineReader(ByteStream stream) : stream_{std::move(stream)}, buffer_(kBuffer) {}
  Status next_slowly(std::string_view& line) noexcept;
  Status fill() noexcept;
  std::string_view cut(const char* begin, std::size_t length) noexcept {
    begin_ += length + 1;
    ++line_number_;
    if (length > 0 && begin[length - 1] == '\r') --length;
    return {begin, length};
  }

  ByteStream stream_;
  bool at_end_{false};
  bool discarding_{false};  // inside a line that was too long
  bool failed_{false};
  std::size_t begin_{0};
  std::size_t end_{0};
  std::uint64_t line_number_{0};
  std::vector<char> buffer_;
};

}  // namespace dampline::drivers
