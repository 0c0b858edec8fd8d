// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>

namespace dampline {

/// The codes of one end of a channel's range, in one block: how many stand at the extreme and how
/// many just inside. Where a sensor clips they pile up at the extreme.
class RangeEnd {
 public:
  static constexpr std::size_t kDepth = 16;  ///< codes kept

  /// `code` grows outwards. Constant time but for a shift by at most kDepth.
  void add(std::int64_t code) noexcept;
  void clear() noexcept { any_ = false; }
  [[nodiscard]] bool any() const noexcept { return any_; }
  [[nodiscard]] std::int64_t extreme() const noexcept { return extreme_; }
  /// Of the `width` outermost codes, and of the `width` next to them.
  [[nodiscard]] std::uint32_t outer(std::size_t width) const noexcept { return sum(0, width); }
  [[nodiscard]] std::uint32_t inner(std::size_t width) const noexcept { return sum(width, width); }

 private:
  [[nodiscard]] std::uint32_t sum(std::size_t first, std::size_t width) const noexcept;
  bool any_{false};
  std::int64_t extreme_{0};
  std::array<std::uint32_t, kDepth> count_{};  // by distance from the extreme
};

/// What a block's codes say of one channel.
struct CodeVerdict {
  int dead_bits{0};            ///< lowest bits that did not move although the channel did
  bool clips{false};           ///< values pile up at an end
  std::int64_t clip_code{0};   ///< the level
  std::int64_t clip_count{0};  ///< samples there in this block
  std::int64_t clip_first{0};  ///< tick of the block's first sample at its extreme
};

/// One channel, code by code: bits that do not move, a pile at the end of the range.
class CodeWatch {
 public:
  void update(std::int64_t tick, std::int64_t code) noexcept;
  /// Judges the block and begins the next one.
  [[nodiscard]] CodeVerdict close() noexcept;

 private:
  static constexpr std::array<std::size_t, 3> kWidths{1, 2, 4};
  struct Pile {  // of all blocks so far, the one sample that each extreme has by definition left
                 // out
    std::array<double, 3> outer{};
    std::array<double, 3> inner{};
    bool found{false};
    std::int64_t level{0};
  };
  [[nodiscard]] static bool judge(Pile& pile, const RangeEnd& end, std::int64_t span) noexcept;

  RangeEnd top_;
  RangeEnd bottom_;
  Pile top_pile_;
  Pile bottom_pile_;
  std::int64_t samples_{0};
  bool any_{false};
  std::int64_t first_code_{0};
  std::uint64_t moved_bits_{0};
  std::int64_t top_tick_{0};
  std::int64_t bottom_tick_{0};
};

}  // namespace dampline
