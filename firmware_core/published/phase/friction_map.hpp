// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "dampline/numeric/information.hpp"
#include "dampline/phase/stroboscope.hpp"
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
/// Points are gathered by cell and velocity sign, each with its own residual variance: noise in the
/// deflection weighs by r' +- g', so the two branches scatter differently. Points must move: stuck
/// ones obey an inequality, not this equation.
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
    if (points_ < kLeastPoints) return out;
    if (clipped()) {
      out.state = FrictionMapState::kClipped;
      return out;
    }
    const Weighted weighted = weigh();
    if (!(weighted.residual_mps2 > 0.0)) return out;
    const Factor factor = regularised(weighted.factor, weighted.residual_mps2);
    typename Factor::Vector theta;
    if (!factor.solve(theta)) return out;
    const auto covariance = factor.inverse();
    const auto estimate = [&](int i) { return Estimate{theta[i], std::sqrt(covariance(i, i))}; };
    for (int j = 0; j < Nodes; ++j) {
      FrictionNode& node = out.nodes[static_cast<std::size_t>(j)];
      node = support(j);
      if (!node.resolved) continue;
      node.restoring_mps2 = estimate(2 * j);
      node.friction_mps2 = estimate(2 * j + 1);
      out.state = FrictionMapState::kReady;
    }
    if constexpr (Viscous) out.viscous_per_s = estimate(2 * Nodes);
    out.residual_mps2 = weighted.residual_mps2;
    return out;
  }

  [[nodiscard]] double node_m(int j) const noexcept { return config_.low_m + j / per_cell_; }
  [[nodiscard]] std::uint64_t points() const noexcept { return points_; }
  [[nodiscard]] std::uint64_t slow() const noexcept { return slow_; }
  [[nodiscard]] std::uint64_t outside() const noexcept { return outside_; }
  [[nodiscard]] std::uint64_t not_finite() const noexcept { return not_finite_; }

  [[nodiscard]] bool clipped() const noexcept { return 4 * outside_ > points_; }

  /// Equations of unit variance in the columns r_0, g_0, r_1, g_1, ..., c if Viscous, right-hand
  /// side: what further models of r and g are fitted from. Nodes without points have empty columns.
  struct Weighted {
    Factor factor{};
    double residual_mps2{0.0};  ///< rms of the unweighted fit; 0: there is none
  };
  /// Two fits: the first tells how the parts scatter. Not for the sample path.
  [[nodiscard]] Weighted weigh() const noexcept {
    Weighted out;
    const Factor first = regularised(gather([](const Part&) { return 1.0; }), 1.0);
    typename Factor::Vector theta;
    if (!first.solve(theta)) return out;
    int used = Viscous ? 1 : 0;
    for (int j = 0; j < Nodes; ++j) used += support(j).resolved ? 2 : 0;
    const double freedom = std::max(static_cast<double>(points_) - used, 1.0);
    double squares = 0.0;
    for (const Part& part : parts_) squares += misfit(part, theta);
    const double pooled = squares / freedom + kRounding * mean_square();
    const double lost = static_cast<double>(points_) / freedom;
    out.residual_mps2 = std::sqrt(pooled);
    out.factor = gather([&](const Part& part) {
      const double own = misfit(part, theta) * lost + kPriorPoints * pooled;
      return std::sqrt((part.points + kPriorPoints) / own);
    });
    return out;
  }

  static constexpr std::uint64_t kLeastPoints = 50;

 private:
  /// Nodes need this many points of each velocity sign.
  static constexpr std::uint32_t kLeastOfEachSign = 10;
  /// Weight of second differences, of the mean information per node; stands in where there is none.
  static constexpr double kSmoothness = 1e-3;
  /// A part's variance counts as many points of the mean variance besides its own.
  static constexpr double kPriorPoints = 5.0;
  static constexpr double kRounding = 1e-24;

  /// Columns: the values r +- g at the two nodes of the cell, v if Viscous, right-hand side.
  using Local = Information<3 + (Viscous ? 1 : 0)>;
  struct Part {
    int cell{0};
    double sign{1.0};
    std::uint32_t points{0};
    Local factor{};
  };

  void absorb(int cell, double share, const PhasePoint& p, double input_mps2) noexcept {
    const bool forward = p.velocity_mps > 0.0;
    Part& part = parts_[static_cast<std::size_t>(2 * cell + (forward ? 1 : 0))];
    part.cell = cell;
    part.sign = forward ? 1.0 : -1.0;
    ++part.points;
    typename Local::Row row = Local::Row::Zero();
    row[0] = 1.0 - share;
    row[1] = share;
    if constexpr (Viscous) row[2] = p.velocity_mps;
    row[Local::kUnknowns] = input_mps2 - p.accel_mps2;
    part.factor.absorb(row);
    ++points_;
  }

  /// All parts' equations, each part's times its weight.
  template <class Weight>
  [[nodiscard]] Factor gather(Weight weight) const noexcept {
    Factor out;
    for (const Part& part : parts_) {
      if (part.points == 0) continue;
      const double w = weight(part);
      for (int i = 0; i < Local::kColumns; ++i) {
        const typename Local::Row local = part.factor.row(i);
        typename Factor::Row row = Factor::Row::Zero();
        row[2 * part.cell] = w * local[0];
        row[2 * part.cell + 1] = w * part.sign * local[0];
        row[2 * part.cell + 2] = w * local[1];
        row[2 * part.cell + 3] = w * part.sign * local[1];
        if constexpr (Viscous) row[2 * Nodes] = w * local[2];
        row[kUnknowns] = w * local[Local::kUnknowns];
        out.absorb(row, 2 * part.cell);
      }
    }
    return out;
  }

  /// Sum of squares that a solution leaves in a part.
  [[nodiscard]] double misfit(const Part& part,
                              const typename Factor::Vector& theta) const noexcept {
    const auto value = [&](int node) { return theta[2 * node] + part.sign * theta[2 * node + 1]; };
    double squares = 0.0;
    for (int i = 0; i < Local::kColumns; ++i) {
      const typename Local::Row local = part.factor.row(i);
      double left = local[0] * value(part.cell) + local[1] * value(part.cell + 1);
      if constexpr (Viscous) left += local[2] * theta[2 * Nodes];
      left -= local[Local::kUnknowns];
      squares += left * left;
    }
    return squares;
  }

  /// Of the right-hand side.
  [[nodiscard]] double mean_square() const noexcept {
    double squares = 0.0;
    for (const Part& part : parts_) {
      const double norm = part.factor.column_norm(Local::kUnknowns);
      squares += norm * norm;
    }
    return squares / static_cast<double>(points_);
  }

  [[nodiscard]] FrictionNode support(int j) const noexcept {
    FrictionNode node{.deflection_m = node_m(j)};
    for (int cell = std::max(j - 1, 0); cell <= std::min(j, Nodes - 2); ++cell) {
      node.negative += parts_[static_cast<std::size_t>(2 * cell)].points;
      node.positive += parts_[static_cast<std::size_t>(2 * cell + 1)].points;
    }
    node.resolved = std::min(node.positive, node.negative) >= kLeastOfEachSign;
    return node;
  }

  /// Second differences of both lines, so light that they decide only what the points do not.
  [[nodiscard]] Factor regularised(Factor out, double residual_mps2) const noexcept {
    const double weight =
        kSmoothness * std::sqrt(static_cast<double>(points_) / Nodes) / residual_mps2;
    for (int i = 0; i < 2 * (Nodes - 2); ++i) {
      typename Factor::Row row = Factor::Row::Zero();
      row[i] = weight;
      row[i + 2] = -2.0 * weight;
      row[i + 4] = weight;
      out.absorb(row, i);
    }
    return out;
  }

  FrictionMapConfig config_;
  double per_cell_{0.0};
  std::uint64_t points_{0};
  std::uint64_t slow_{0};
  std::uint64_t outside_{0};
  std::uint64_t not_finite_{0};
  std::array<Part, 2 * static_cast<std::size_t>(Nodes - 1)> parts_{};
};

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
