// SPDX-License-Identifier: MIT
#include "dampline/effect/diagnosis.hpp"

#include <algorithm>
#include <cmath>

#include "dampline/motion/reference_low_pass.hpp"

namespace dampline::effect {
namespace {

constexpr double kStillShareLimit = 0.5;  // as the Estimator's gate
constexpr double kStartScaleM = 1.0e-3;

/// The half power of two nearest to a length, in units of a millimetre.
double rounded_scale(double length_m) noexcept {
  const double steps = std::round(2.0 * std::log2(std::max(length_m, 1e-9) / 1e-3));
  return 1e-3 * std::exp2(0.5 * steps);
}

Grids scaled(Grids grids, double scale_m) noexcept {
  grids.scale_m = scale_m;
  return grids;
}

}  // namespace

Diagnosis::Diagnosis(const EstimatorConfig& config, const Grids& grids) noexcept
    : sample_rate_hz_{config.sample_rate_hz},
      block_ticks_{std::lround(Estimator::kBlockS * config.sample_rate_hz)},
      lift_{VelocityLift{ReferenceLowPass::seen_behind(config.anti_alias), config.sample_rate_hz}
                .taps()},
      pitch_share_{config.frame_pitch_mass_kg / config.moving_mass_kg},
      raw_{config.sample_rate_hz, config.far_mass_kg / config.moving_mass_kg,
           config.frame_pitch_mass_kg > 0.0},
      rows_{config.sample_rate_hz},
      mean_{scaled(grids, grids.scale_m > 0.0 ? grids.scale_m : kStartScaleM),
            1.0 / config.sample_rate_hz},
      scale_known_{grids.scale_m > 0.0} {
  const double step_s = 1.0 / sample_rate_hz_;
  for (std::size_t i = 0; i < kFlexibleModes; ++i) {
    flexible_[i] =
        Resonator{grids.flexible[i].frequency_hz, grids.flexible[i].damping_ratio, step_s};
  }
}

void Diagnosis::update(const Sample& sample, const UpdateResult& result) noexcept {
  raw_.push(sample);
  store_.step();
  column_tick_ = -1;
  if (result.has_motion) take(result.motion);
}

bool Diagnosis::learn(const Motion& motion) noexcept {
  if (scale_known_) return true;
  if (motion.still) return false;
  learnt_squares_ += motion.deflection_m * motion.deflection_m;
  if (static_cast<double>(++learnt_) < kLearningS * sample_rate_hz_) return false;
  const double rms_m = std::sqrt(learnt_squares_ / static_cast<double>(learnt_));
  mean_ = LawMean{scaled(grids(), rounded_scale(rms_m)), 1.0 / sample_rate_hz_};
  scale_known_ = true;
  in_stretch_ = false;
  return true;
}

/// y'' with its fast part lifted as that of the velocity, whose rate it is.
double Diagnosis::lifted_mps2(std::int64_t tick) const noexcept {
  double sum = 0.0;
  tick -= VelocityLift::kHalf;
  for (const double tap : lift_) {
    const auto& a = raw_.at(tick++).accel_mps2;
    sum += tap * (2.0 * a[0] - a[1] - a[2]);
  }
  return sum;
}

void Diagnosis::restart(const Motion& motion) noexcept {
  in_stretch_ = true;
  for (Resonator& r : flexible_) r.reset();
  mean_.reset(instant_of(motion));
  first_row_tick_ = -1;
}

Instant Diagnosis::instant_of(const Motion& motion) noexcept {
  const RawRing::Entry& now = raw_.at(motion.tick);
  Instant out;
  out.deflection_m = {motion.deflection_m, motion.velocity_mps};
  out.velocity_mps = {motion.velocity_mps, lifted_mps2(motion.tick)};
  out.wheelset1_mps = {now.wheelset_mps[0], now.accel_mps2[1]};
  out.wheelset2_mps = {now.wheelset_mps[1], now.accel_mps2[2]};
  const RawRing::Entry& before = raw_.at(motion.tick - 1);
  const RawRing::Entry& after = raw_.at(motion.tick + 1);
  // A broken line through samples weakens what is fast; [-1 14 -1] / 12 undoes that.
  const auto sharpened = [&](auto&& of) {
    return (14.0 * of(now) - of(before) - of(after)) / 12.0;
  };
  out.turn_mps2 =
      sharpened([](const RawRing::Entry& e) { return -0.5 * (e.accel_mps2[1] - e.accel_mps2[2]); });
  const double push = sharpened([](const RawRing::Entry& e) { return -e.accel_mps2[0]; });
  before_last_ = last_bend_;
  for (std::size_t i = 0; i < kFlexibleModes; ++i) {
    flexible_[i].update(push);
    last_bend_[kModeBend + static_cast<int>(i)] = static_cast<float>(flexible_[i].bend());
  }
  return out;
}

void Diagnosis::take(const Motion& motion) noexcept {
  if (!learn(motion)) return;
  if (in_stretch_ && motion.tick != last_tick_ + 1) {
    close_before(block_of(motion.tick));
    in_stretch_ = false;
  }
  last_tick_ = motion.tick;
  if (!any_block_) open_block_ = block_of(motion.tick);
  any_block_ = true;
  if (!in_stretch_) return restart(motion);
  if (!motion.still) {
    moving_ += 1.0;
    velocity_squares_ += motion.velocity_mps * motion.velocity_mps;
    deflection_squares_ += motion.deflection_m * motion.deflection_m;
  }
  const Rows::Sampled left = before_last_;
  const Rows::Sampled centre = last_bend_;
  const LawValues laws = mean_.update(instant_of(motion));
  Rows::Sampled values = (left + 10.0F * centre + last_bend_) / 12.0F;
  values.head<kLawColumns>() = laws;
  Turn turn;
  if (pitch_share_ > 0.0) {
    const RawRing::Entry& now = raw_.at(motion.tick);
    turn = turn_.update({motion.velocity_mps, now.turn_mps, now.turn_m, now.end_mps2});
  }
  if (mean_.complete()) {
    if (first_row_tick_ < 0) first_row_tick_ = motion.tick - 1;
    rows_.set(motion.tick - 1, values, still_);
    if (pitch_share_ > 0.0)
      rows_.set_turn(motion.tick - 1, turn.spring_m, pitch_share_ * turn.push_mps2);
    column_tick_ = motion.tick - 1;
    build_rows(motion.tick - 1);
  }
  still_ = motion.still;
}

void Diagnosis::build_rows(std::int64_t newest) noexcept {
  for (std::size_t s = 0; s < kScales; ++s) {
    const int half = rows_.bank().half(s);
    const std::int64_t centre = newest - half;
    if (centre - half < first_row_tick_) continue;
    const int stride = rows_.bank().stride(s);
    if (centre % stride != stride / 2) continue;
    if (rows_.still_share(s, centre) > kStillShareLimit) continue;
    const Row row = rows_.row(s, centre, raw_);
    store_.absorb(block_of(centre), s, row);
    if (s == ImpulseMeter::kScale) impulses_.update(centre, row);
  }
  close_before(block_of(std::max<std::int64_t>(newest - rows_.bank().half(0) - 1, 0)));
}

void Diagnosis::close_before(std::int64_t block) noexcept {
  // What was skipped by a gap has no rows.
  open_block_ = std::max(open_block_, block - 3);
  for (; open_block_ < block; ++open_block_) store_.close(open_block_);
}

void Diagnosis::finish() noexcept {
  if (any_block_) close_before(block_of(last_tick_) + 1);
  store_.finish();
}

double Diagnosis::velocity_rms_mps() const noexcept {
  return moving_ > 0.0 ? std::sqrt(velocity_squares_ / moving_) : 0.0;
}
double Diagnosis::deflection_rms_m() const noexcept {
  return moving_ > 0.0 ? std::sqrt(deflection_squares_ / moving_) : 0.0;
}

}  // namespace dampline::effect
