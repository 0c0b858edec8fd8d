// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "drivers/compressed/decompressor.hpp"
#include "drivers/outcome.hpp"

namespace dampline::drivers {

/// A file that is read anywhere in it. Shared by the ranges that read from it.
class RandomFile {
 public:
  static Outcome<std::shared_ptr<RandomFile>> open(const std::string& path);
  RandomFile(const RandomFile&) = delete;
  RandomFile& operator=(const RandomFile&) = delete;
  ~RandomFile();
  /// Bytes that are there, up to out.size(); less at the file's end or where reading fails.
  [[nodiscard]] std::size_t read(std::uint64_t offset, std::span<char> out) const noexcept;
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }

 private:
  RandomFile(int descriptor, std::uint64_t size) : descriptor_{descriptor}, size_{size} {}
  int descriptor_;
  std::uint64_t size_;
};

/// Bytes of one stretch of a file in their order through a fixed buffer, inflated or as they are.
class FileRange {
 public:
  FileRange(std::shared_ptr<RandomFile> file, std::uint64_t begin, std::uint64_t bytes,
            std::unique_ptr<Decompressor> inflate = nullptr)
      : file_{std::move(file)},
        next_{begin},
        left_{bytes},
        inflate_{std::move(inflate)},
        buffer_(kBuffer) {}
  /// The next `count` bytes; fewer at the end, none for damaged data. Precondition: at most
  /// kLongest. The view is good until the next call.
  [[nodiscard]] std::span<const char> look(std::size_t count) noexcept;
  /// Precondition: they were looked at.
  void drop(std::size_t count) noexcept { begin_ += count; }

  static constexpr std::size_t kLongest = std::size_t{128} * 1024;

 private:
  static constexpr std::size_t kBuffer = std::size_t{192} * 1024;
  static constexpr std::size_t kPacked = std::size_t{32} * 1024;
  [[nodiscard]] bool fill() noexcept;
  [[nodiscard]] std::size_t read_some(std::span<char> out) noexcept;

  std::shared_ptr<RandomFile> file_;
  std::uint64_t next_;
  std::uint64_t left_;
  std::unique_ptr<Decompressor> inflate_;  // null: the bytes are as they are
  std::vector<char> packed_;
  std::size_t packed_begin_{0};
  std::size_t packed_end_{0};
  std::vector<char> buffer_;
  std::size_t begin_{0};
  std::size_t end_{0};
};

}  // namespace dampline::drivers
