// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "drivers/bytes/byte_stream.hpp"

namespace dampline::drivers {

/// A ByteStream through one fixed buffer: so many bytes at a time as a format needs to see.
class ByteReader {
 public:
  using Status = ByteStream::Status;

  ByteReader(ByteStream stream, std::size_t capacity)
      : stream_{std::move(stream)}, buffer_(capacity) {}

  /// kBytes: at least `count` bytes are there; kEnd: the stream ends before. Precondition: count
  /// is at most the capacity less 4.
  [[nodiscard]] Status need(std::size_t count) noexcept {
    while (end_ - begin_ < count) {
      if (buffer_.size() - end_ < std::max<std::size_t>(4, count - (end_ - begin_))) {
        std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
        end_ -= begin_;
        begin_ = 0;
      }
      const ByteStream::Read part = stream_.read(std::span{buffer_}.subspan(end_));
      end_ += part.count;
      if (part.status != Status::kBytes) return part.status;
    }
    return Status::kBytes;
  }
  [[nodiscard]] std::span<const char> bytes() const noexcept {
    return std::span{buffer_}.subspan(begin_, end_ - begin_);
  }
  /// Precondition: so many bytes are there.
  void drop(std::size_t count) noexcept {
    begin_ += count;
    offset_ += count;
  }
  /// Of the next byte, in the decompressed file.
  [[nodiscard]] std::uint64_t offset() const noexcept { return offset_; }
  [[nodiscard]] ByteStream& stream() noexcept { return stream_; }
  [[nodiscard]] const ByteStream& stream() const noexcept { return stream_; }

 private:
  ByteStream stream_;
  std::vector<char> buffer_;
  std::size_t begin_{0};
  std::size_t end_{0};
  std::uint64_t offset_{0};
};

}  // namespace dampline::drivers
