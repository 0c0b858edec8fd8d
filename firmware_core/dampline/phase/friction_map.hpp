// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "dampline/estimate/information.hpp"
#include "dampline/phase/phase_point.hpp"
#include "dampline/result.hpp"
#include "dampline/snapshot.hpp"

namespace dampline {

struct FrictionMapConfig {
  double low_m{0.0};   ///< first node
  double high_m{0.0};  ///< last node
  double least_speed_mps{
      0.0};  ///< slower points are left out: their sign may be wrong, or they stick
};

/// Restoring and friction force per unit of mass at one deflection.
struct FrictionNode {
  double deflection_m{0.0};
  bool resolved{false};  ///< both velocity signs were seen often enough; without it, no estimates
  Estimate restoring_mps2{};
  Estimate friction_mps2{};
  std::uint32_t positive{0};  ///< points with v > 0 in the two neighbouring cells
  std::uint32_t negative{0};
};

enum class FrictionMapState : std::uint8_t {
  kNotEnough,  ///< fewer than 50 points, or not one node with both velocity signs
  kClipped,    ///< more than 20 % of the points lie outside the nodes
  kReady
};

template <int Nodes>
struct FrictionCurve {
  FrictionMapState state{FrictionMapState::kNotEnough};
  std::array<FrictionNode, static_cast<std::size_t>(Nodes)> nodes{};
  Estimate viscous_per_s{};
  double residual_mps2{0.0};  ///< rms
};

/// r(y) and g(y) of y'' + c y' + g(y) sgn y' + r(y) = input, both as broken lines over equally
/// spaced nodes, jointly by least squares: at one deflection, the two signs of the velocity tell
/// the one from the other. Viscous: whether c is among the unknowns.
///
/// Points must move: stuck ones obey an inequality, not this equation. One update is about
/// 20 Nodes^2 operations.
template <int Nodes, bool Viscous = false>
class FrictionMap {
  static_assert(Nodes >= 3);

 public:
  static constexpr int kNodes = Nodes;
  static constexpr int kUnknowns = 2 * Nodes + (Viscous ? 1 : 0);
  using Factor = Information<kUnknowns + 1>;

  /// kInvalidConfig unless the nodes span a finite width above 0 and the least speed is not below
  /// 0.
  [[nodiscard]] static Result<FrictionMap> make(const FrictionMapConfig& config) noexcept {
    const double width = config.high_m - config.low_m;
    if (!(width > 0.0) || !std::isfinite(width) || !(config.least_speed_mps >= 0.0))
      return Errc::kInvalidConfig;
    FrictionMap map;
    map.config_ = config;
    map.per_cell_ = (Nodes - 1) / width;
    return map;
  }

  /// `input_mps2`: the driving force per unit of mass at the point.
  void add(const PhasePoint& p, double input_mps2) noexcept {
    if (!is_finite(p) || !std::isfinite(input_mps2)) {
      ++not_finite_;
      return;
    }
    if (!(std::abs(p.velocity_mps) > config_.least_speed_mps)) {
      ++slow_;
      return;
    }
    const double place = (p.deflection_m - config_.low_m) * per_cell_;
    if (!(place >= 0.0) || !(place <= Nodes - 1)) {
      ++outside_;
      return;
    }
    const int cell = std::min(static_cast<int>(place), Nodes - 2);
    absorb(cell, place - cell, p, input_mps2);
  }

  [[nodiscard]] FrictionCurve<Nodes> curve() const noexcept {
    FrictionCurve<Nodes> out;
    if (points_ < 50) return out;
    if (4 * outside_ > points_) {
      out.state = FrictionMapState::kClipped;
      return out;
    }
    const Factor factor = regularised();
    typename Factor::Vector theta;
    if (!factor.solve(theta)) return out;
    const auto covariance = factor.inverse();
    const double variance = residual_variance();
    const auto estimate = [&](int i) {
      return Estimate{theta[i], std::sqrt(variance * covariance(i, i))};
    };
    for (int j = 0; j < Nodes; ++j) {
      FrictionNode& node = out.nodes[static_cast<std::size_t>(j)];
      node = support(j);
      if (!node.resolved) continue;
      node.restoring_mps2 = estimate(2 * j);
      node.friction_mps2 = estimate(2 * j + 1);
      out.state = FrictionMapState::kReady;
    }
    if constexpr (Viscous) out.viscous_per_s = estimate(2 * Nodes);
    out.residual_mps2 = std::sqrt(variance);
    return out;
  }

  [[nodiscard]] double node_m(int j) const noexcept { return config_.low_m + j / per_cell_; }
  [[nodiscard]] std::uint64_t points() const noexcept { return points_; }
  [[nodiscard]] std::uint64_t slow() const noexcept { return slow_; }
  [[nodiscard]] std::uint64_t outside() const noexcept { return outside_; }
  [[nodiscard]] std::uint64_t not_finite() const noexcept { return not_finite_; }

  /// Columns r_0, g_0, r_1, g_1, ..., c if Viscous, right-hand side: what further models of r and
  /// g are fitted from. Nodes without points have empty columns.
  [[nodiscard]] const Factor& factor() const noexcept { return factor_; }

 private:
  /// Nodes that need both signs need this many points of each.
  static constexpr std::uint32_t kLeastOfEachSign = 10;
  /// Of the mean information per node; stands in where there is none.
  static constexpr double kSmoothness = 1e-3;

  struct CellCount {
    std::uint32_t positive{0};
    std::uint32_t negative{0};
  };

  void absorb(int cell, double share, const PhasePoint& p, double input_mps2) noexcept {
    const double sign = p.velocity_mps > 0.0 ? 1.0 : -1.0;
    typename Factor::Row row = Factor::Row::Zero();
    row[2 * cell] = 1.0 - share;
    row[2 * cell + 1] = sign * (1.0 - share);
    row[2 * cell + 2] = share;
    row[2 * cell + 3] = sign * share;
    if constexpr (Viscous) row[2 * Nodes] = p.velocity_mps;
    row[kUnknowns] = input_mps2 - p.accel_mps2;
    factor_.absorb(row, 2 * cell);
    CellCount& count = cells_[static_cast<std::size_t>(cell)];
    ++(sign > 0.0 ? count.positive : count.negative);
    ++points_;
  }

  [[nodiscard]] FrictionNode support(int j) const noexcept {
    FrictionNode node{.deflection_m = node_m(j)};
    for (int cell = std::max(j - 1, 0); cell <= std::min(j, Nodes - 2); ++cell) {
      node.positive += cells_[static_cast<std::size_t>(cell)].positive;
      node.negative += cells_[static_cast<std::size_t>(cell)].negative;
    }
    node.resolved = std::min(node.positive, node.negative) >= kLeastOfEachSign;
    return node;
  }

  /// Second differences of both lines, so light that they decide only what the points do not.
  [[nodiscard]] Factor regularised() const noexcept {
    Factor out = factor_;
    const double weight = kSmoothness * std::sqrt(static_cast<double>(points_) / Nodes);
    for (int i = 0; i < 2 * (Nodes - 2); ++i) {
      typename Factor::Row row = Factor::Row::Zero();
      row[i] = weight;
      row[i + 2] = -2.0 * weight;
      row[i + 4] = weight;
      out.absorb(row, i);
    }
    return out;
  }

  [[nodiscard]] double residual_variance() const noexcept {
    int used = Viscous ? 1 : 0;
    for (int j = 0; j < Nodes; ++j) used += 2 * (support(j).resolved ? 1 : 0);
    const double left = factor_.residual_norm();
    return left * left / std::max(static_cast<double>(points_) - used, 1.0);
  }

  FrictionMapConfig config_;
  double per_cell_{0.0};
  std::uint64_t points_{0};
  std::uint64_t slow_{0};
  std::uint64_t outside_{0};
  std::uint64_t not_finite_{0};
  std::array<CellCount, static_cast<std::size_t>(Nodes - 1)> cells_{};
  Factor factor_;
};

}  // namespace dampline
