// SPDX-License-Identifier: MIT
#include "app/diagnosis/truck/points.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace dampline::app {

namespace {

constexpr std::size_t kRing = 2048;  // more than the integral's delay
constexpr double kMeanS = 1.0;

}  // namespace

std::vector<double> mean_weights(double rate_hz) {
  const auto half = static_cast<int>(std::lround(0.5 * kMeanS * rate_hz));
  std::vector<double> out;
  double sum = 0.0;
  for (int n = -half; n <= half; ++n) {
    out.push_back(0.5 + 0.5 * std::cos(std::numbers::pi * n / (half + 1)));
    sum += out.back();
  }
  for (double& w : out) w /= sum;
  return out;
}

TruckPoints::TruckPoints(double sample_rate_hz, double moving_mass_kg,
                         const effect::Explanation& explanation, Outlets outlets)
    : rate_hz_{sample_rate_hz},
      mass_kg_{moving_mass_kg},
      explanation_{explanation},
      outlets_{std::move(outlets)},
      position_{DriftFreeIntegral{sample_rate_hz}, DriftFreeIntegral{sample_rate_hz}},
      waiting_(kRing),
      weights_{mean_weights(sample_rate_hz)},
      held_(weights_.size()) {}

void TruckPoints::take(const Sample& sample, const UpdateResult& result,
                       const effect::Diagnosis& diagnosis) {
  if (!first_tick_) first_tick_ = sample.tick;
  const std::int64_t tick = diagnosis.column_tick();
  if (tick >= 0 && any_motion_ && last_motion_.tick == tick) {
    if (tick != last_tick_ + 1) restart();
    last_tick_ = tick;
    start_row(tick, last_motion_, diagnosis);
  }
  any_motion_ = any_motion_ || result.has_motion;
  if (result.has_motion) last_motion_ = result.motion;
}

void TruckPoints::restart() {
  for (DriftFreeIntegral& p : position_) p.reset();
  held_count_ = 0;
  if (outlets_.gap) outlets_.gap();
}

void TruckPoints::start_row(std::int64_t tick, const Motion& motion,
                            const effect::Diagnosis& diagnosis) {
  Waiting& w = waiting_[static_cast<std::size_t>(tick) % kRing];
  const effect::RawRing::Entry& now = diagnosis.raw().at(tick);
  const double before = diagnosis.raw().at(tick - 1).accel_mps2[0];
  const double after = diagnosis.raw().at(tick + 1).accel_mps2[0];
  w.row.setZero();
  w.row.head<effect::kSampledColumns>() = diagnosis.columns().cast<double>();
  w.row[effect::kFrameRate] = 0.5 * rate_hz_ * (after - before);
  w.row[effect::kWheelset1Once] = now.wheelset_mps[0];
  w.row[effect::kWheelset2Once] = now.wheelset_mps[1];
  w.row[effect::kFrameOnce] =
      0.5 * (motion.velocity_mps + now.wheelset_mps[0] + now.wheelset_mps[1]);
  // The columns are averages over the neighbours; so is what they are compared with.
  w.row[effect::kTarget] = -(diagnosis.raw().at(tick - 1).pushed_mps2 + 10.0 * now.pushed_mps2 +
                             diagnosis.raw().at(tick + 1).pushed_mps2) /
                           12.0;
  w.point.time_s = static_cast<double>(tick - *first_tick_) / rate_hz_;
  w.point.deflection_m = motion.deflection_m;
  w.point.velocity_mps = motion.velocity_mps;
  w.point.channel = now.accel_mps2;
  std::array<double, 2> position_m{};
  bool ready = true;
  for (std::size_t i = 0; i < 2; ++i)
    ready = position_[i].update(now.wheelset_mps[i], position_m[i]) && ready;
  if (ready) finish_row(tick - position_[0].delay(), position_m[0], position_m[1]);
}

void TruckPoints::finish_row(std::int64_t tick, double wheelset1_m, double wheelset2_m) {
  Waiting& w = waiting_[static_cast<std::size_t>(tick) % kRing];
  w.row[effect::kWheelset1Twice] = wheelset1_m;
  w.row[effect::kWheelset2Twice] = wheelset2_m;
  w.row[effect::kFrameTwice] = 0.5 * (w.point.deflection_m + wheelset1_m + wheelset2_m);
  const effect::Explanation& e = explanation_;
  w.point.measured_n = mass_kg_ * w.row[effect::kTarget];
  w.point.base_n = mass_kg_ * effect::ModelFitter::force(e.base_model, e.base, w.row);
  w.point.final_n = mass_kg_ * effect::ModelFitter::force(e.model, e.final, w.row);
  filter(w.point);
}

void TruckPoints::filter(const EvidencePoint& point) {
  const std::size_t size = held_.size();
  held_[held_count_ % size] = point;
  if (++held_count_ < size) return;
  double measured = 0.0;
  double base = 0.0;
  double final = 0.0;
  for (std::size_t i = 0; i < size; ++i) {
    const EvidencePoint& p = held_[(held_count_ + i) % size];
    measured += weights_[i] * p.measured_n;
    base += weights_[i] * p.base_n;
    final += weights_[i] * p.final_n;
  }
  EvidencePoint out = held_[(held_count_ + size / 2) % size];
  out.measured_n -= measured;
  out.base_n -= base;
  out.final_n -= final;
  outlets_.point(out);
}

}  // namespace dampline::app
