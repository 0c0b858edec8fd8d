// SPDX-License-Identifier: MIT
#include "published/phase/planarity.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace dampline {
namespace {

constexpr int kPlane = 2;  // y and v
constexpr int kUnknowns = PlanarityFactor::kUnknowns;
constexpr double kDetermined = 1e-6;  // of a column's norm before the regimes took their constants
constexpr std::uint64_t kLeastPoints = 30;

using Flags = std::array<bool, kUnknowns>;

/// The factor without the columns that the ones before them determine.
PlanarityFactor reduced(const PlanarityFactor& full, const PlanarityFactor::Row& squares,
                        Flags& determined) noexcept {
  PlanarityFactor out = full;
  for (int column = 0; column < kUnknowns; ++column) {
    auto& flag = determined[static_cast<std::size_t>(column)];
    flag = out.at(column, column) > kDetermined * std::sqrt(squares[column]);
    if (flag) continue;
    PlanarityFactor without;
    for (int i = 0; i < PlanarityFactor::kColumns; ++i) {
      PlanarityFactor::Row row = out.row(i);
      row[column] = 0.0;
      without.absorb(row, i);
    }
    out = without;
  }
  return out;
}

/// Solves and inverts around the columns that are left out, whose pivots become 1.
void estimate(const PlanarityFactor& factor, const Flags& determined, double variance,
              PlanarityVerdict& out) noexcept {
  PlanarityFactor regular = factor;
  for (int i = 0; i < kUnknowns; ++i) {
    PlanarityFactor::Row pin = PlanarityFactor::Row::Zero();
    pin[i] = 1.0;
    if (!determined[static_cast<std::size_t>(i)]) regular.absorb(pin, i);
  }
  PlanarityFactor::Vector theta;
  if (!regular.solve(theta)) return;
  const auto covariance = regular.inverse();
  const std::array<Estimate*, kUnknowns> to{&out.deflection_per_s2, &out.velocity_per_s,
                                            &out.sign_mps2, &out.deflection_sign_per_s2,
                                            &out.cubic_per_m2s2};
  for (int i = 0; i < kUnknowns; ++i)
    if (determined[static_cast<std::size_t>(i)])
      *to[static_cast<std::size_t>(i)] = {theta[i], std::sqrt(variance * covariance(i, i))};
}

bool varies(double sum2, double sum, std::uint64_t points) noexcept {
  const auto n = static_cast<double>(points);
  const double variance = sum2 / n - sum / n * (sum / n);
  return variance > 1e-20 * sum2 / n;
}

}  // namespace

void PlanaritySums::add(const PhasePoint& p, const PlanarityFactor::Row& row) noexcept {
  ++points;
  sum_y += p.deflection_m;
  sum_v += p.velocity_mps;
  squares += row.cwiseProduct(row);
}

PlanarityFactor::Row planarity_row(const PhasePoint& p, double input_mps2) noexcept {
  const double y = p.deflection_m;
  const double v = p.velocity_mps;
  const double sign = v > 0.0 ? 1.0 : (v < 0.0 ? -1.0 : 0.0);
  PlanarityFactor::Row row;
  row << y, v, sign, y * sign, y * y * y, p.accel_mps2 - input_mps2;
  return row;
}

PlanarityVerdict judge_planarity(const PlanarityFactor& total, const PlanaritySums& sums) noexcept {
  PlanarityVerdict out{.points = sums.points, .slow = sums.slow, .not_finite = sums.not_finite};
  if (sums.points == 0 && sums.slow > 0) out.state = PlanarityState::kNoMotion;
  if (sums.points < kLeastPoints + sums.nuisances + kUnknowns) return out;
  out.state = PlanarityState::kNoMotion;
  if (!varies(sums.squares[0], sums.sum_y, sums.points) ||
      !varies(sums.squares[1], sums.sum_v, sums.points))
    return out;
  Flags determined{};
  const PlanarityFactor factor = reduced(total, sums.squares, determined);
  int unknowns = 0;
  for (const bool flag : determined) unknowns += flag ? 1 : 0;
  double explained = 0.0;
  for (int i = kPlane; i < kUnknowns; ++i) {
    out.terms += determined[static_cast<std::size_t>(i)] ? 1 : 0;
    explained += factor.at(i, kUnknowns) * factor.at(i, kUnknowns);
  }
  const double left = factor.residual_norm() * factor.residual_norm();
  const auto n = static_cast<double>(sums.points);
  const double degrees = n - static_cast<double>(sums.nuisances) - unknowns;
  const double squares = sums.squares[kUnknowns];
  out.index = squares > 0.0 ? std::sqrt((left + explained) / squares) : 0.0;
  out.state = PlanarityState::kNotDetermined;
  if (out.terms == 0) return out;
  // Rounding is not a departure: what is left of an exact plane counts as that much.
  const double rounding = 1e-24 * squares;
  const double variance = (left + rounding) / degrees;
  out.f = explained / out.terms / variance;
  out.gain = explained / (explained + left + rounding);
  const bool real = explained > 1e3 * rounding;
  out.state = real && out.f > kPlanarityThreshold && out.gain > kPlanarityLeastGain
                  ? PlanarityState::kNonlinear
                  : PlanarityState::kLinear;
  estimate(factor, determined, variance, out);
  return out;
}

}  // namespace dampline
