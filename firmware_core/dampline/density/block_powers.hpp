// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace dampline {

/// Mean power of motion and of input over consecutive stretches of the record, in fixed memory:
/// when all slots are full, neighbours become one. With forgetting, the slots are a ring instead.
class BlockPowers {
 public:
  static constexpr std::size_t kSlots = 32;

  /// `memory_blocks` 0: the whole record; else the last three memories.
  explicit BlockPowers(double memory_blocks) noexcept;

  void take(double velocity_mps, double input_mps2) noexcept {
    open_.motion += velocity_mps * velocity_mps;
    open_.input += input_mps2 * input_mps2;
    open_.count += 1.0;
  }
  void close_block() noexcept;
  /// Adds another record's stretches behind these.
  void append(const BlockPowers& other) noexcept;

  struct Change {
    double size{0.0};    ///< largest |ln(power of a quarter / mean power)|, of motion or input
    double chance{0.0};  ///< its standard deviation in a stationary record
    bool known{false};   ///< at least eight stretches
  };
  [[nodiscard]] Change change() const noexcept;

 private:
  struct Power {
    double motion{0.0}, input{0.0}, count{0.0};
    void add(const Power& other) noexcept;
  };
  void push(const Power& slot) noexcept;
  void coarsen() noexcept;
  [[nodiscard]] Change change_of(double Power::*power) const noexcept;

  bool rings_;
  std::uint32_t blocks_per_slot_{1};
  std::uint32_t blocks_{0};  // in open_
  Power open_{};
  std::array<Power, kSlots> slots_{};
  std::size_t size_{0};
  std::size_t oldest_{0};
};

}  // namespace dampline
