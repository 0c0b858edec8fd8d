// SPDX-License-Identifier: MIT
#pragma once
#include "dampline/effect/effect_laws.hpp"

namespace dampline::effect {

/// The laws between samples: motion by the cubic Hermite polynomial, laws at four points a sample,
/// each column averaged by the hat function of two samples' width (as the base law's, LawAverage).
class LawMean {
 public:
  LawMean(const Grids& grids, double step_s) noexcept
      : laws_{grids, 0.25 * step_s},
        quarter_{Hermite::at(0.25, step_s)},
        half_{Hermite::at(0.5, step_s)},
        three_quarters_{Hermite::at(0.75, step_s)} {}

  /// Takes the motion at sample n; returns the averages at n - 1, meaningful once complete().
  LawValues update(const Instant& instant) noexcept {
    const Hermite start = Hermite::at(0.0, 0.0);
    const LawValues p0 = laws_(start(last_, instant));
    const LawValues p1 = laws_(quarter_(last_, instant));
    const LawValues p2 = laws_(half_(last_, instant));
    const LawValues p3 = laws_(three_quarters_(last_, instant));
    LawValues mean = from_left_ + (4.0F * p0 + 3.0F * p1 + 2.0F * p2 + p3) / 16.0F;
    from_left_ = (p1 + 2.0F * p2 + 3.0F * p3) / 16.0F;
    last_ = instant;
    ++count_;
    return mean;
  }
  [[nodiscard]] bool complete() const noexcept { return count_ >= 3; }
  void reset(const Instant& first) noexcept {
    laws_.reset();
    last_ = first;
    from_left_.setZero();
    count_ = 0;
  }
  [[nodiscard]] const Grids& grids() const noexcept { return laws_.grids(); }

 private:
  EffectLaws laws_;
  Hermite quarter_, half_, three_quarters_;
  Instant last_{};
  LawValues from_left_ = LawValues::Zero();
  int count_{0};
};

}  // namespace dampline::effect
