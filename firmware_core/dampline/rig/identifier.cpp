// SPDX-License-Identifier: MIT
#include "dampline/rig/identifier.hpp"

#include <algorithm>
#include <cmath>

namespace dampline::rig {
namespace {

constexpr std::size_t kZeroPositive = kCurveSegments + 1;

/// Velocity of point i; the branch v < 0 comes first, outermost node first.
double velocity_of(std::size_t i, const Config& config) noexcept {
  if (i < kCurveSegments) return -config.curve_nodes_mps[kCurveSegments - 1 - i];
  if (i <= kZeroPositive) return 0.0;
  return config.curve_nodes_mps[i - kZeroPositive - 1];
}

/// What unknown j adds to the force at a point, per unit: the regressors of one velocity.
ModelInformation::Vector weights_at(const Model& model, double velocity_mps, bool positive,
                                    const Config& config) noexcept {
  Block::Row row = Block::Row::Zero();
  Regressors{config}.fill_branch(positive, std::abs(velocity_mps), row);
  ModelInformation::Vector out{};
  for (int j = 0; j < model.size(); ++j) out[static_cast<std::size_t>(j)] = model.value(j, row);
  return out;
}

constexpr double kMaxStillShare = 0.5;
/// Share of a value that remains as its standard deviation however long the record: the derivative
/// window shifts reversals by a part of a sample. Simulated rigs show a bias of 0.02 to 0.04 %.
constexpr double kFloor = 5e-4;

}  // namespace

std::size_t nearest_point(const Config& config, double velocity_mps) noexcept {
  const auto& nodes = config.curve_nodes_mps;
  const double speed = std::abs(velocity_mps);
  std::size_t rank = 0;  // 0: v = 0
  double lower = 0.0;
  while (rank < kCurveSegments && speed > 0.5 * (lower + nodes[rank])) lower = nodes[rank++];
  return velocity_mps > 0.0 ? kZeroPositive + rank : kCurveSegments - rank;
}

Curve curve_of(const Solution& solution, const Config& config,
               const std::array<std::uint64_t, kCurvePoints>& support) noexcept {
  Curve out;
  out.valid = solution.valid;
  if (!solution.valid) return out;
  for (std::size_t i = 0; i < kCurvePoints; ++i) {
    if (support[i] == 0) continue;
    const double velocity = velocity_of(i, config);
    const auto weights = weights_at(solution.model, velocity, i >= kZeroPositive, config);
    double force = 0.0;
    for (std::size_t j = 0; j < weights.size(); ++j) force += weights[j] * solution.theta[j];
    out.points[out.size++] = {velocity, force, solution.std_of(weights), support[i]};
  }
  return out;
}

Identifier::Identifier(const Config& config) noexcept
    : config_{config}, motion_{config}, rows_{config}, store_{config.block_samples} {}

int Identifier::latency_samples() const noexcept {
  return motion_.latency_samples() + 2 * rows_.half();
}

Status Identifier::classify(const Sample& sample) noexcept {
  if (++counts_.samples == 1) {
    first_tick_ = sample.tick;
    last_tick_ = sample.tick - 1;
  }
  const std::int64_t step = sample.tick - last_tick_;
  if (step <= 0) {
    ++counts_.repeated;
    return Status::kRepeated;
  }
  last_tick_ = sample.tick;
  const bool finite = is_finite(sample, config_.velocity_measured);
  if (!finite) ++counts_.not_finite;
  if (step > 1) {
    ++counts_.gaps;
    counts_.lost += static_cast<std::uint64_t>(step - 1);
    first_tick_ += step - 1;  // blocks count samples: a pause of hours must not fill them
  }
  if (!finite) return Status::kNotFinite;
  return step > 1 ? Status::kGap : Status::kUsed;
}

Status Identifier::update(const Sample& sample) noexcept {
  const Status status = classify(sample);
  if (status == Status::kRepeated) return status;
  if (status != Status::kUsed) {
    motion_.reset();
    rows_.reset();
  }
  if (status == Status::kNotFinite) return status;
  Motion motion;
  if (motion_.update(sample, motion)) take(motion);
  return status;
}

void Identifier::take(const Motion& motion) noexcept {
  ++support_[nearest_point(config_, motion.velocity_mps)];
  Row row;
  if (!rows_.update(motion, row)) return;
  if (row.still_share > kMaxStillShare) {
    ++counts_.rows_still;
    return;
  }
  ++counts_.rows;
  store_.absorb(row.centre_tick - first_tick_, row.row);
}

Solution Identifier::solution(const Terms& terms) const noexcept {
  return solve(store_, Model{terms});
}

Snapshot Identifier::snapshot(const Terms& terms) const noexcept {
  Snapshot out;
  out.counts = counts_;
  const Solution fit = solution(terms);
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
  out.curve = curve_of(solve(store_, Model::curve(terms)), config_, support_);
  return out;
}

}  // namespace dampline::rig
