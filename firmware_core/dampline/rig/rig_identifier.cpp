// SPDX-License-Identifier: MIT
#include "dampline/rig/rig_identifier.hpp"

#include <cmath>

#include "dampline/rig/rig_curve.hpp"

namespace dampline {
namespace {

constexpr double kMaxStillShare = 0.5;
/// Share of a value that remains as its standard deviation however long the record: the derivative
/// window shifts reversals by a part of a sample. Simulated rigs show a bias of 0.02 to 0.04 %.
constexpr double kFloor = 5e-4;

}  // namespace

RigIdentifier::RigIdentifier(const RigConfig& config) noexcept
    : config_{config}, motion_{config}, rows_{config}, store_{config.block_samples} {}

int RigIdentifier::latency_samples() const noexcept {
  return motion_.latency_samples() + 2 * rows_.half();
}

bool RigIdentifier::finite(const RigSample& sample) const noexcept {
  if (!std::isfinite(sample.deflection_m) || !std::isfinite(sample.force_n)) return false;
  return !config_.velocity_measured || std::isfinite(sample.velocity_mps);
}

void RigIdentifier::restart() noexcept {
  motion_.reset();
  rows_.reset();
}

RigStatus RigIdentifier::classify(const RigSample& sample) noexcept {
  if (++counts_.samples == 1) {
    first_tick_ = sample.tick;
    last_tick_ = sample.tick - 1;
  }
  const std::int64_t step = sample.tick - last_tick_;
  if (step <= 0) {
    ++counts_.repeated;
    return RigStatus::kRepeated;
  }
  last_tick_ = sample.tick;
  if (!finite(sample)) ++counts_.not_finite;
  if (step > 1) {
    ++counts_.gaps;
    counts_.lost += static_cast<std::uint64_t>(step - 1);
  }
  if (!finite(sample)) return RigStatus::kNotFinite;
  return step > 1 ? RigStatus::kGap : RigStatus::kUsed;
}

RigStatus RigIdentifier::update(const RigSample& sample) noexcept {
  const RigStatus status = classify(sample);
  if (status == RigStatus::kRepeated) return status;
  if (status != RigStatus::kUsed) restart();
  if (status == RigStatus::kNotFinite) return status;
  RigMotion motion;
  if (motion_.update(sample, motion)) take(motion);
  return status;
}

void RigIdentifier::take(const RigMotion& motion) noexcept {
  ++support_[nearest_rig_point(config_, motion.velocity_mps)];
  RigRow row;
  if (!rows_.update(motion, row)) return;
  if (row.still_share > kMaxStillShare) {
    ++counts_.rows_still;
    return;
  }
  ++counts_.rows;
  store_.absorb(row.centre_tick - first_tick_, row.row);
}

RigSolution RigIdentifier::solution(const RigTerms& terms) const noexcept {
  return solve(store_, RigModel{terms});
}

RigSnapshot RigIdentifier::snapshot(const RigTerms& terms) const noexcept {
  RigSnapshot out;
  out.counts = counts_;
  const RigSolution fit = solution(terms);
  out.counts.blocks = fit.blocks;
  out.valid = fit.valid;
  if (!fit.valid) return out;
  out.size = static_cast<std::size_t>(fit.model.size());
  for (std::size_t j = 0; j < out.size; ++j) {
    const int i = static_cast<int>(j);
    const double std = std::hypot(std::sqrt(fit.covariance(i, i)), kFloor * fit.theta[j]);
    out.estimates[j] = {fit.model.parameter(i), {fit.theta[j], std}};
  }
  out.nmse = fit.nmse;
  out.held_out_nmse = fit.held_out_nmse;
  out.residual_n = fit.residual_n;
  out.curve = rig_curve(solve(store_, RigModel::curve(terms)), config_, support_);
  return out;
}

}  // namespace dampline
