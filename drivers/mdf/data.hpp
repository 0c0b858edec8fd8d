// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "drivers/compressed/decompressor.hpp"
#include "drivers/mdf/block.hpp"

namespace dampline::drivers {

/// The bytes of a data block, or of a list of them, one behind the other through one fixed buffer:
/// plain (DT, SD, DV), deflated (DZ), or deflated with rows and columns exchanged, one such block
/// at a time in memory. Circles of lists are refused: no more is read than the file has.
class MdfData {
 public:
  /// at 0: no data. `open_ended`: a block without a length goes to the file's end.
  MdfData(std::shared_ptr<RandomFile> file, MdfLink at, bool open_ended);
  /// The next `count` bytes; fewer at the end or where fault() says why. Precondition: at most
  /// kLongest. The view is good until the next call.
  [[nodiscard]] std::span<const char> look(std::size_t count) noexcept;
  /// Passes over so many bytes, seen or not; false: there are fewer.
  [[nodiscard]] bool skip(std::uint64_t count) noexcept;
  /// Empty: nothing is wrong. With the byte of the block.
  [[nodiscard]] const std::string& fault() const noexcept { return fault_; }
  /// The last block reaches beyond the file's end.
  [[nodiscard]] bool is_cut_off() const noexcept { return cut_off_; }
  /// Data values: their records have no invalidation bits.
  [[nodiscard]] bool is_values() const noexcept { return values_; }
  /// Of all bytes in the file that were read so far, stored.
  [[nodiscard]] std::uint64_t stored_bytes() const noexcept { return visited_; }

  static constexpr std::size_t kLongest = std::size_t{64} * 1024;
  static constexpr std::uint64_t kMostTransposed = std::uint64_t{64} * 1024 * 1024;

 private:
  [[nodiscard]] bool fill() noexcept;
  [[nodiscard]] std::size_t give(std::span<char> room) noexcept;
  [[nodiscard]] std::size_t inflated(std::span<char> room) noexcept;
  [[nodiscard]] bool next_block() noexcept;
  [[nodiscard]] bool open_list(MdfLink at) noexcept;
  [[nodiscard]] bool open_block(const MdfHead& head) noexcept;
  [[nodiscard]] bool open_deflated(const MdfHead& head) noexcept;
  [[nodiscard]] bool transpose(std::uint32_t columns) noexcept;
  [[nodiscard]] bool visit(const MdfHead& head) noexcept;
  bool fail(MdfLink at, const char* what) noexcept;

  std::shared_ptr<RandomFile> file_;
  bool open_ended_;
  MdfLink first_;  // not opened yet; 0: it is
  MdfHead list_{};
  std::uint64_t entry_{0};    // next one in list_
  std::uint64_t entries_{0};  // 0: there is no list
  std::uint64_t lists_{0};    // opened so far
  MdfLink marked_{0};         // a list before this one; whoever comes back to it goes in a circle
  std::uint64_t visited_{0};  // bytes of the blocks that were opened
  MdfLink block_{0};          // of the piece
  std::uint64_t raw_next_{0};
  std::uint64_t raw_left_{0};
  bool deflated_{false};
  std::uint64_t inflated_left_{0};
  std::unique_ptr<Decompressor> inflate_;
  std::vector<char> packed_;
  std::size_t packed_begin_{0};
  std::size_t packed_end_{0};
  std::vector<char> transposed_;
  std::size_t transposed_at_{0};
  std::size_t transposed_columns_{1};
  std::vector<char> buffer_;
  std::size_t begin_{0};
  std::size_t end_{0};
  bool values_{false};
  bool cut_off_{false};
  std::string fault_;
};

}  // namespace dampline::drivers
