// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "dampline/sample.hpp"

namespace dampline {

/// Counts samples that say in all channels what the one before said. Without a counter that is how
/// a repeated sample looks; by chance it happens too, as often as with the sample before that.
class RepeatWatch {
 public:
  using Codes = std::array<std::int64_t, kChannels>;
  /// True when the codes are those of the sample before.
  bool update(const Codes& codes) noexcept {
    const bool same = seen_ >= 1 && codes == last_[0];
    const bool chance = seen_ >= 2 && codes == last_[1];
    if (same) repeated_ += 1.0;
    if (chance) chance_ += 1.0;
    last_[1] = last_[0];
    last_[0] = codes;
    if (seen_ < 2) ++seen_;
    return same;
  }
  /// More than chance explains, with kAllowed on top.
  [[nodiscard]] bool found() const noexcept {
    return repeated_ >= kAllowed + 4.0 * std::sqrt(chance_ + 1.0) + kChance * chance_;
  }
  [[nodiscard]] double excess() const noexcept { return repeated_ - chance_; }
  /// Once a block: what is long ago counts less, with a time constant of some 40 blocks.
  void forget() noexcept {
    repeated_ *= kKept;
    chance_ *= kKept;
  }
  void clear() noexcept { repeated_ = chance_ = 0.0; }
  void restart() noexcept { seen_ = 0; }

 private:
  static constexpr double kAllowed = 5.0;
  static constexpr double kChance = 5.0;  // of smooth motion the nearer sample is the more alike
  static constexpr double kKept = 0.975;
  std::array<Codes, 2> last_{};
  int seen_{0};
  double repeated_{0.0};
  double chance_{0.0};
};

}  // namespace dampline
