// SPDX-License-Identifier: MIT
#include "dampline/rig/predictor.hpp"

#include <algorithm>
#include <cmath>

namespace dampline::rig {
namespace {

bool has_inertia(const Model& model) noexcept {
  return model.size() > 0 && model.parameter(0) == Parameter::kMovingMass;
}

}  // namespace

Predictor::Predictor(const Config& config, const Solution& solution,
                     std::int64_t block_samples) noexcept
    : config_{config},
      solution_{solution},
      block_samples_{block_samples},
      motion_{config},
      regressors_{config},
      psi_{half_support_samples(config.prediction_corner_hz, config.sample_rate_hz),
           1.0 / config.sample_rate_hz},
      delay_{has_inertia(solution.model) ? psi_.half() : 0} {}

const Motion& Predictor::ago(int samples) const noexcept {
  return ring_[static_cast<std::size_t>((next_ - 1 - samples + 2 * kRing) % kRing)];
}

double Predictor::acceleration_mps2() const noexcept {
  double sum = 0.0;
  for (int j = -delay_; j <= delay_; ++j) sum += psi_.at(j).second * ago(delay_ - j).deflection_m;
  return sum;
}

Prediction Predictor::predict(const Motion& motion) const noexcept {
  Block::Row row = Block::Row::Zero();
  regressors_.fill(motion, row);
  if (delay_ > 0) row[column::kInertia] = acceleration_mps2();
  row[column::kStiffness] = motion.deflection_m;
  row[column::kViscous] = motion.velocity_mps;
  const auto block = static_cast<std::size_t>((motion.tick - first_tick_) / block_samples_);
  Prediction out{motion.tick, motion.deflection_m, motion.velocity_mps, motion.force_n, 0, 0};
  for (int j = 0; j < solution_.model.size(); ++j) {
    const auto i = static_cast<std::size_t>(j);
    const double value = solution_.model.value(j, row);
    out.fitted_n += value * solution_.theta[i];
    out.held_out_n += value * solution_.theta_without[fold_of(block)][i];
  }
  return out;
}

void Predictor::count(const Prediction& prediction) noexcept {
  ++sums_.samples;
  const double fitted = prediction.measured_n - prediction.fitted_n;
  const double held_out = prediction.measured_n - prediction.held_out_n;
  sums_.nmse += fitted * fitted;
  sums_.held_out_nmse += held_out * held_out;
  const double delta = prediction.measured_n - mean_n_;
  mean_n_ += delta / static_cast<double>(sums_.samples);
  squares_n2_ += delta * (prediction.measured_n - mean_n_);
}

bool Predictor::update(const Sample& sample, Prediction& out) noexcept {
  if (!started_) {
    first_tick_ = sample.tick;
    last_tick_ = sample.tick - 1;
    started_ = true;
  }
  const std::int64_t step = sample.tick - last_tick_;
  if (step <= 0) return false;
  last_tick_ = sample.tick;
  if (step > 1) first_tick_ += step - 1;  // as the Identifier counts
  const bool finite = is_finite(sample, config_.velocity_measured);
  if (step > 1 || !finite) {
    motion_.reset();
    seen_ = 0;
  }
  Motion motion;
  if (!finite || !motion_.update(sample, motion)) return false;
  ring_[static_cast<std::size_t>(next_)] = motion;
  next_ = (next_ + 1) % kRing;
  seen_ = std::min(seen_ + 1, kRing);
  if (seen_ < 2 * delay_ + 1) return false;
  out = predict(ago(delay_));
  count(out);
  return true;
}

Errors Predictor::errors() const noexcept {
  Errors out = sums_;
  if (!(squares_n2_ > 0.0)) return {};
  out.nmse /= squares_n2_;
  out.held_out_nmse /= squares_n2_;
  return out;
}

}  // namespace dampline::rig
