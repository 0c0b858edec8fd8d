// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "dampline/numeric/log_histogram.hpp"
#include "dampline/sample.hpp"

namespace dampline {

/// The resolution of a channel for which none is declared: the least change between two samples. A
/// moving channel changes by one code within seconds.
class StepMeter {
 public:
  /// Of one sample of the channel.
  void update(double value) noexcept {
    const double change = std::abs(value - last_);
    last_ = value;
    if (!any_) {
      any_ = true;
    } else if (change > kSame) {
      least_ = least_ > 0.0 ? std::min(least_, change) : change;
    }
  }
  /// In the channel's unit; 0: it never changed.
  [[nodiscard]] double step() const noexcept { return least_; }

 private:
  static constexpr double kSame = 1e-9;  // rounding of a value that was printed
  bool any_{false};
  double last_{0.0};
  double least_{0.0};
};

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
  /// Lowest bits that have not moved in this block; some before the first ones do.
  [[nodiscard]] int dead_bits() const noexcept {
    return std::min(std::countr_zero(moved_bits_), kMostDead);
  }
  /// No code of this block lies beyond it.
  [[nodiscard]] bool is_extreme(std::int64_t code) const noexcept {
    return code >= top_.extreme() || -code >= bottom_.extreme();
  }
  /// Judges the block and begins the next one.
  [[nodiscard]] CodeVerdict close() noexcept;

 private:
  static constexpr std::array<std::size_t, 3> kWidths{1, 2, 4};
  static constexpr int kMostDead = 16;
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

/// Counts samples that say in all channels what the one before said. Without a counter that is how
/// a repeated sample looks; by chance it happens too, as often as with the sample before that.
/// Where the car hardly moves it says nothing; after a fast move chance has no part in it, and a
/// few close together are enough.
class RepeatWatch {
 public:
  using Codes = std::array<std::int64_t, kChannels>;
  /// `together_samples`: repetitions that close belong together.
  explicit RepeatWatch(std::int64_t together_samples) noexcept
      : together_samples_{together_samples} {}
  /// True when the codes are those of the sample before.
  bool update(std::int64_t tick, const Codes& codes) noexcept {
    const bool same = seen_ >= 2 && codes == last_[0] && moved(kMoves);
    const bool chance = seen_ >= 2 && codes == last_[1] && moved(kMoves);
    if (same) join(tick);
    if (seen_ >= 1) samples_ += 1.0;
    for (std::size_t c = 0; seen_ >= 1 && c < kChannels; ++c)
      if (codes[c] == last_[0][c]) alike_[c] += 1.0;
    if (same) repeated_ += 1.0;
    if (chance) chance_ += 1.0;
    last_[1] = last_[0];
    last_[0] = codes;
    if (seen_ < 2) ++seen_;
    return same;
  }
  /// More than chance explains, with kAllowed on top; or together after fast moves.
  [[nodiscard]] bool found() const noexcept {
    return is_together() || repeated_ >= kAllowed + 4.0 * std::sqrt(chance_ + 1.0) +
                                             kChance * chance_ +
                                             2.0 * std::max(by_chance() - kFewByChance, 0.0);
  }
  [[nodiscard]] double excess() const noexcept {
    return is_together() ? together_ : repeated_ - chance_;
  }
  /// Once a block: what is long ago counts less, with a time constant of some 40 blocks.
  void forget() noexcept {
    earlier_ = kKept * by_chance();
    repeated_ *= kKept;
    chance_ *= kKept;
    samples_ = 0.0;
    alike_.fill(0.0);
  }
  /// The first of them; -1: there is none.
  [[nodiscard]] std::int64_t first_tick() const noexcept {
    return is_together() ? first_together_ : first_tick_;
  }
  /// What was found is reported; more that is together with it is found at once.
  void clear() noexcept {
    known_ = known_ || together_ > 0.0;
    repeated_ = chance_ = together_ = 0.0;
    first_tick_ = first_together_ = -1;
  }
  void restart() noexcept { seen_ = 0; }

 private:
  [[nodiscard]] bool is_together() const noexcept {
    return together_ >= (known_ ? 1.0 : kTogether) && by_chance() < kFewByChance;
  }
  void join(std::int64_t tick) noexcept {
    if (tick - last_tick_ > together_samples_) {
      together_ = 0.0;
      known_ = false;
      first_together_ = -1;
    }
    if (first_together_ < 0) first_together_ = tick;
    if (moved(kFastMoves) && all_moved()) together_ += 1.0;
    if (first_tick_ < 0) first_tick_ = tick;
    last_tick_ = tick;
  }
  /// Before this sample.
  [[nodiscard]] bool moved(std::int64_t least) const noexcept {
    std::int64_t codes = 0;
    for (std::size_t c = 0; c < kChannels; ++c) codes += std::abs(last_[0][c] - last_[1][c]);
    return codes >= least;
  }
  [[nodiscard]] bool all_moved() const noexcept {
    bool all = true;
    for (std::size_t c = 0; c < kChannels; ++c) all = all && last_[0][c] != last_[1][c];
    return all;
  }
  /// Repetitions of all channels if each repeated its code by itself: slow motion, coarse steps.
  /// Block by block, since a car that brakes moves otherwise before.
  [[nodiscard]] double by_chance() const noexcept {
    double count = samples_;
    for (const double alike : alike_) count *= alike / std::max(samples_, 1.0);
    return earlier_ + count;
  }
  static constexpr std::int64_t kMoves = 6;  // codes, of all channels together
  static constexpr std::int64_t kFastMoves = 24;
  static constexpr double kTogether = 3.0;
  static constexpr double kAllowed = 5.0;
  static constexpr double kFewByChance = 2.0;  // 1.2 in the reference runs
  static constexpr double kChance = 5.0;  // of smooth motion the nearer sample is the more alike
  static constexpr double kKept = 0.975;
  std::int64_t together_samples_;
  std::array<Codes, 2> last_{};
  int seen_{0};
  double together_{0.0};  // after fast moves, and not yet reported
  bool known_{false};     // some of them are
  std::int64_t first_together_{-1};
  std::int64_t last_tick_{0};
  std::int64_t first_tick_{-1};
  double repeated_{0.0};
  double chance_{0.0};
  double earlier_{0.0};  // by chance, in the blocks before
  double samples_{0.0};  // of this block
  std::array<double, kChannels> alike_{};
};

/// A jump of a channel's zero.
struct LevelJump {
  std::int64_t tick{0};
  double size_mps2{0.0};
};

/// One channel's means over a second; a jump is a difference between the five seconds after and the
/// five before one second that stands out from all such differences.
class LevelWatch {
 public:
  explicit LevelWatch(std::int64_t second_samples) noexcept : second_{second_samples} {}
  /// True when it wrote a jump, some 10 s after it happened.
  bool update(std::int64_t tick, double accel_mps2, LevelJump& jump) noexcept;
  void restart() noexcept;

 private:
  static constexpr std::size_t kSide = 5;
  static constexpr std::size_t kSeconds = 2 * kSide + 1;
  [[nodiscard]] bool end_second(std::int64_t tick, LevelJump& jump) noexcept;

  std::int64_t second_;
  std::int64_t samples_{0};
  double sum_{0.0};
  std::array<double, kSeconds> mean_{};  // oldest first
  std::size_t seconds_{0};
  MagnitudeHistogram differences_;  // in 0.1 mm/s^2
  LevelJump peak_{};                // the largest of a run of outstanding differences
  int since_peak_{-1};              // seconds; -1: there is none
};

}  // namespace dampline
