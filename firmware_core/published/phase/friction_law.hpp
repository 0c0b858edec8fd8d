// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "dampline/numeric/information.hpp"
#include "dampline/snapshot.hpp"
#include "published/phase/friction_map.hpp"

namespace dampline {

enum class FrictionLawState : std::uint8_t {
  kNotEnough,
  kConstant,  ///< the friction does not vary with deflection beyond its deviation: no y_c
  kVarying
};

/// Structural friction H1 |1 + y / y_c| sgn v beside a linear spring.
struct FrictionLaw {
  FrictionLawState state{FrictionLawState::kNotEnough};
  Estimate friction_mps2{};     ///< H1 per unit of mass
  Estimate reversal_m{};        ///< y_c; only with kVarying
  Estimate stiffness_per_s2{};  ///< k per unit of mass
  Estimate restoring_mps2{};    ///< restoring force at y = 0
  Estimate viscous_per_s{};     ///< c per unit of mass; only if the map has it
  double residual_mps2{0.0};    ///< rms
};

/// Fits the law to what a map has accumulated, without another look at the points. Not for the
/// sample path.
///
/// At the nodes the law is exact, and so is the broken line between them but for the cell that
/// holds the kink at y = -y_c. With that cell known, g = +-(H1 + b y) is linear in H1 and b, and
/// the two nodes of the cell get free values; so every cell is tried, beside the straight line.
template <int Nodes, bool Viscous>
class FrictionLawFit {
 public:
  using Map = FrictionMap<Nodes, Viscous>;

  [[nodiscard]] static FrictionLaw fit(const Map& map) noexcept {
    if (map.points() < Map::kLeastPoints || map.clipped()) return {};
    const typename Map::Weighted weighted = map.weigh();
    if (!(weighted.residual_mps2 > 0.0)) return {};
    const Trial straight = solve(map, weighted, kNoKink);
    Trial best;
    for (int cell = 0; cell + 1 < Nodes; ++cell) {
      const Trial trial = solve(map, weighted, cell);
      if (trial.solved && kink_is_in(map, trial, cell) &&
          (!best.solved || trial.squares < best.squares))
        best = trial;
    }
    if (!best.solved) return straight.law;
    if (!straight.solved) return best.law;
    const bool worth_it = straight.squares - best.squares > kWorthAKink * best.variance;
    return worth_it ? best.law : straight.law;
  }

 private:
  // Columns: restoring force at 0, k, [c], H1, b, two free values, right-hand side.
  static constexpr int kH = 2 + (Viscous ? 1 : 0);
  static constexpr int kFree = kH + 2;
  static constexpr int kColumns = kFree + 3;
  static constexpr int kNoKink = -1;
  /// Squares, in variances, that a kink must take away: 40 for the three unknowns it brings.
  static constexpr double kWorthAKink = 40.0;
  static constexpr double kConstantSigmas = 3.0;
  using Factor = Information<kColumns>;
  using Mapping = Eigen::Matrix<double, Map::kUnknowns + 1, kColumns>;

  struct Trial {
    bool solved{false};
    double squares{0.0};   ///< of the equations of unit variance
    double variance{1.0};  ///< squares per degree of freedom
    double kink_m{0.0};
    FrictionLaw law{};
  };

  static Mapping mapping(const Map& map, int kink_cell) noexcept {
    Mapping m = Mapping::Zero();
    for (int j = 0; j < Nodes; ++j) {
      const double y = map.node_m(j);
      const double side = j <= kink_cell ? -1.0 : 1.0;
      m(2 * j, 0) = 1.0;
      m(2 * j, 1) = y;
      m(2 * j + 1, kH) = side;
      m(2 * j + 1, kH + 1) = side * y;
    }
    if (kink_cell != kNoKink) {
      m(2 * kink_cell + 1, kFree) = 1.0;
      m(2 * kink_cell + 3, kFree + 1) = 1.0;
    }
    if constexpr (Viscous) m(2 * Nodes, 2) = 1.0;
    m(Map::kUnknowns, kColumns - 1) = 1.0;
    return m;
  }

  static Trial solve(const Map& map, const typename Map::Weighted& weighted,
                     int kink_cell) noexcept {
    Factor factor;
    weighted.factor.add_mapped(mapping(map, kink_cell), 1.0, factor);
    for (int i = 0; i < 2; ++i) {  // so light that it decides only where there are no points
      typename Factor::Row pin = Factor::Row::Zero();
      pin[kFree + i] = 1e-3;
      factor.absorb(pin, kFree + i);
    }
    Trial out;
    typename Factor::Vector theta;
    if (!factor.solve(theta)) return out;
    out.solved = true;
    out.squares = factor.residual_norm() * factor.residual_norm();
    out.kink_m = -theta[kH] / theta[kH + 1];
    out.variance = out.squares / std::max(static_cast<double>(map.points()) - kColumns, 1.0);
    out.law = law(factor, theta, out.variance);
    out.law.residual_mps2 = weighted.residual_mps2 * std::sqrt(out.variance);
    return out;
  }

  /// A little beyond the cell as well: noise may push a kink near a node across it.
  static bool kink_is_in(const Map& map, const Trial& trial, int cell) noexcept {
    const double slack = 0.25 * (map.node_m(1) - map.node_m(0));
    return trial.law.state == FrictionLawState::kVarying &&
           trial.kink_m > map.node_m(cell) - slack && trial.kink_m < map.node_m(cell + 1) + slack;
  }

  static FrictionLaw law(const Factor& factor, const typename Factor::Vector& theta,
                         double variance) noexcept {
    FrictionLaw out;
    const auto covariance = factor.inverse();
    const auto estimate = [&](int i) {
      return Estimate{theta[i], std::sqrt(variance * covariance(i, i))};
    };
    out.restoring_mps2 = estimate(0);
    out.stiffness_per_s2 = estimate(1);
    if constexpr (Viscous) out.viscous_per_s = estimate(2);
    const Estimate h = estimate(kH);
    const Estimate b = estimate(kH + 1);
    out.friction_mps2 = {std::abs(h.value), h.std};
    out.state = FrictionLawState::kConstant;
    if (!(std::abs(b.value) > kConstantSigmas * b.std)) return out;
    out.state = FrictionLawState::kVarying;
    const double reversal = h.value / b.value;
    const double spread = covariance(kH, kH) - 2.0 * reversal * covariance(kH, kH + 1) +
                          reversal * reversal * covariance(kH + 1, kH + 1);
    out.reversal_m = {reversal, std::sqrt(variance * std::max(spread, 0.0)) / std::abs(b.value)};
    return out;
  }
};

}  // namespace dampline
