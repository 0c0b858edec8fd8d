// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <cstdint>

#include "dampline/damping/smooth_sign.hpp"
#include "dampline/effect/diagnosis.hpp"
#include "dampline/identifier.hpp"

namespace dampline::bench {

/// A law that no grid holds: Stribeck friction with its own decay speed, or a mass on the frame
/// with its own frequency and damping.
struct TrueLaw {
  double stribeck_mps{0.0};  ///< 0: the mass
  double frequency_hz{9.0};
  double damping_ratio{0.03};
};

/// The sums of a Diagnosis, with one law's true column in the place of all points of its grid.
class TrueSums {
 public:
  TrueSums(double sample_rate_hz, const TrueLaw& law)
      : law_{law},
        step_s_{1.0 / sample_rate_hz},
        block_ticks_{std::lround(Identifier::kBlockS * sample_rate_hz)},
        rows_{sample_rate_hz} {}

  /// What the Diagnosis made of its newest sample.
  void take(const UpdateResult& result, const effect::Diagnosis& diagnosis) {
    store_.step();
    if (!result.has_motion) return;
    const Motion& motion = result.motion;
    if (motion.tick != last_tick_ + 1) restart(motion);
    last_tick_ = motion.tick;
    const float column = law_.stribeck_mps > 0.0 ? friction(motion) : bend(motion, diagnosis.raw());
    if (diagnosis.column_tick() == motion.tick - 1) add(column, diagnosis);
    was_still_ = motion.still;
    last_ = motion;
  }
  [[nodiscard]] const effect::GramStore& finish() {
    close_before(last_tick_ / block_ticks_ + 1);
    store_.finish();
    return store_;
  }

 private:
  void restart(const Motion& motion) {
    last_ = motion;
    from_left_ = 0.0;
    resonator_ = effect::Resonator{law_.frequency_hz, law_.damping_ratio, step_s_};
    bend_ = before_ = 0.0;
    first_tick_ = -1;
    open_block_ = std::max(open_block_, motion.tick / block_ticks_);
  }
  [[nodiscard]] double law_at(double v) const {
    return smooth_sign(v, effect::kInnerWidthMps) * std::exp(-std::abs(v) / law_.stribeck_mps);
  }
  /// The mean with a hat of two samples' width, at the sample before.
  float friction(const Motion& now) {
    const auto at = [&](double u) {
      const auto weights = effect::Hermite::at(u, step_s_);
      return law_at(weights(effect::Slope{last_.velocity_mps, last_.relative_mps2},
                            effect::Slope{now.velocity_mps, now.relative_mps2}));
    };
    const double p0 = at(0.0);
    const double p1 = at(0.25);
    const double p2 = at(0.5);
    const double p3 = at(0.75);
    const double mean = from_left_ + (4.0 * p0 + 3.0 * p1 + 2.0 * p2 + p3) / 16.0;
    from_left_ = (p1 + 2.0 * p2 + 3.0 * p3) / 16.0;
    return static_cast<float>(mean);
  }
  float bend(const Motion& now, const effect::RawRing& raw) {
    const auto push = [&](std::int64_t tick) { return -raw.at(tick).accel_mps2[0]; };
    const double left = before_;
    const double centre = bend_;
    before_ = bend_;
    resonator_.update((14.0 * push(now.tick) - push(now.tick - 1) - push(now.tick + 1)) / 12.0);
    bend_ = resonator_.bend();
    return static_cast<float>((left + 10.0 * centre + bend_) / 12.0);
  }
  void add(float column, const effect::Diagnosis& diagnosis) {
    const std::int64_t newest = diagnosis.column_tick();
    effect::EffectRows::Sampled values = diagnosis.columns();
    const bool friction = law_.stribeck_mps > 0.0;
    const int first = friction ? effect::kStribeck : effect::kModeBend;
    const std::size_t count = friction ? effect::kStribeckSpeeds : effect::kFlexibleModes;
    for (int i = 0; i < static_cast<int>(count); ++i) values[first + i] = column;
    rows_.set(newest, values, was_still_);
    if (first_tick_ < 0) first_tick_ = newest;
    for (std::size_t s = 0; s < kScales; ++s) {
      const int half = rows_.bank().half(s);
      const int stride = rows_.bank().stride(s);
      const std::int64_t centre = newest - half;
      if (centre - half < first_tick_ || centre % stride != stride / 2) continue;
      if (rows_.still_share(s, centre) > 0.5) continue;
      store_.absorb(centre / block_ticks_, s, rows_.row(s, centre, diagnosis.raw()));
    }
    close_before(std::max<std::int64_t>(newest - rows_.bank().half(0) - 1, 0) / block_ticks_);
  }
  void close_before(std::int64_t block) {
    for (; open_block_ < block; ++open_block_) store_.close(open_block_);
  }

  TrueLaw law_;
  double step_s_;
  std::int64_t block_ticks_;
  effect::EffectRows rows_;
  effect::GramStore store_;
  effect::Resonator resonator_;
  Motion last_{};
  double from_left_{0.0};
  double bend_{0.0}, before_{0.0};
  std::int64_t last_tick_{-2};
  std::int64_t first_tick_{-1};
  std::int64_t open_block_{0};
  bool was_still_{false};
};

}  // namespace dampline::bench
