// SPDX-License-Identifier: MIT
#include "dampline/rig/motion.hpp"

#include <algorithm>
#include <cmath>

namespace dampline::rig {

DerivativeWindow::DerivativeWindow(int half_width, double interval_s) noexcept
    : half_width_{std::clamp(half_width, 1, kMaxVelocityHalfWidth)} {
  double moment = 0.0;
  for (int j = 1; j <= half_width_; ++j) {
    const double u = static_cast<double>(j) / (half_width_ + 1);
    const double weight = j * (1.0 - u * u) * (1.0 - u * u);
    weights_[static_cast<std::size_t>(j)] = weight;
    moment += 2.0 * j * weight;
  }
  for (double& weight : weights_) weight /= moment * interval_s;
}

DerivativeWindow DerivativeWindow::sharp(double interval_s) noexcept {
  DerivativeWindow out{3, interval_s};
  constexpr std::array<double, 4> kSixthOrder{0.0, 3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0};
  for (std::size_t j = 0; j < kSixthOrder.size(); ++j)
    out.weights_[j] = kSixthOrder[j] / interval_s;
  return out;
}

double DerivativeWindow::noise_gain() const noexcept {
  double sum = 0.0;
  for (const double weight : weights_) sum += 2.0 * weight * weight;
  return std::sqrt(sum);
}

MotionEstimator::MotionEstimator(const Config& config) noexcept
    : window_{config.velocity_sharp
                  ? DerivativeWindow::sharp(1.0 / config.sample_rate_hz)
                  : DerivativeWindow{config.velocity_half_width, 1.0 / config.sample_rate_hz}},
      velocity_measured_{config.velocity_measured} {}

const Sample& MotionEstimator::ago(int samples) const noexcept {
  const int index = (next_ - 1 - samples + 2 * kRing) % kRing;
  return ring_[static_cast<std::size_t>(index)];
}

double MotionEstimator::newest_velocity() const noexcept {
  const int centre = window_.half_width();
  if (velocity_measured_) return ago(centre).velocity_mps;
  double sum = 0.0;
  for (int j = 1; j <= centre; ++j)
    sum += window_.weight(j) * (ago(centre - j).deflection_m - ago(centre + j).deflection_m);
  return sum;
}

bool MotionEstimator::update(const Sample& sample, Motion& out) noexcept {
  ring_[static_cast<std::size_t>(next_)] = sample;
  next_ = (next_ + 1) % kRing;
  const int ready = 2 * window_.half_width() + 1;
  seen_ = std::min(seen_ + 1, ready + 2);
  if (seen_ < ready) return false;
  velocity_ = {velocity_[1], velocity_[2], newest_velocity()};
  if (seen_ < ready + 2) return false;
  const Sample& centre = ago(latency_samples());
  out = {centre.tick,  centre.deflection_m, velocity_[0],
         velocity_[1], velocity_[2],        centre.force_n};
  return true;
}

}  // namespace dampline::rig
