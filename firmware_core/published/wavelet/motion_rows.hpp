// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/numeric/information.hpp"
#include "dampline/result.hpp"
#include "published/wavelet/models.hpp"
#include "published/wavelet/sign_gate.hpp"
#include "published/wavelet/stencil.hpp"

// Wavelet-Galerkin rows from measured deflection and force (Ghanem and Romeo, International Journal
// of Non-Linear Mechanics 36 (2001) 835-859, equation 13).
//
// A forced Duffing oscillator, m x'' + c x' + k x + k3 x^3 = f, over a whole run:
//
//   using Duffing = SingleModel<TermList<Viscous, Spring, CubicSpring>>;
//   auto rows = MotionRows<D12, Duffing>::make({.step_s = 0.05, .mass_kg = {1.0}},
//   Duffing{}).value(); Information<Duffing::kUnknowns + 1> information; MotionRow<Duffing> row;
//   for (each sample) {
//     if (rows.push({.deflection_m = {x}, .force_n = {f}}, row) && row.usable) {
//       information.absorb(row.equation(0));
//     }
//   }
//   Information<Duffing::kUnknowns + 1>::Vector c_k_k3;
//   const bool determined = information.solve(c_k_k3);
//
// A chain of two masses with the same kind of elements and exact Coulomb friction in both; the gate
// is in the model's type, and the two equations share the six unknowns c, k, e of each element:
//
//   using Element = TermList<Viscous, Spring, Friction<>>;
//   using Chain = ChainModel<Element, Element>;
//   auto rows = MotionRows<D8, Chain>::make({.step_s = 1e-3, .mass_kg = {12.0, 12.0}}, Chain{});
//   ... rows.push({.deflection_m = {x1, x2}, .force_n = {f1, f2}}, row) ...
//   for (int d = 0; d < Chain::kDof; ++d) information.absorb(row.equation(d));

namespace dampline {

/// One instant of a measured system.
template <int Dof>
struct MotionSample {
  PerDof<Dof> deflection_m{};
  PerDof<Dof> force_n{};
};

/// The equations of one instant: one per degree of freedom.
template <class M>
struct MotionRow {
  static constexpr int kColumns = M::kUnknowns + 1;
  using Equation = Eigen::Matrix<double, kColumns, 1>;

  std::int64_t sample{0};  ///< number of the instant, counted from the first push
  PerDof<M::kDof> deflection_m{};
  PerDof<M::kDof> velocity_mps{};
  PerDof<M::kDof> accel_mps2{};
  PerDof<M::kDof> target_n{};  ///< f - m x''
  Regressors<M::kDof, M::kUnknowns> regressors = Regressors<M::kDof, M::kUnknowns>::Zero();
  bool usable{false};  ///< no reversal and no stick within the stencil

  /// [regressors | target] of equation `dof`.
  [[nodiscard]] Equation equation(int dof) const noexcept {
    Equation out;
    out.template head<M::kUnknowns>() = regressors.row(dof).transpose();
    out[M::kUnknowns] = target_n[static_cast<std::size_t>(dof)];
    return out;
  }
};

/// What rows at any level are made with.
template <int Dof>
struct MotionRowsConfig {
  double step_s{0.0};
  PerDof<Dof> mass_kg{};
  GateConfig gate{};

  [[nodiscard]] bool valid() const noexcept {
    bool ok = step_s > 0.0 && gate.least_speed_mps >= 0.0 && gate.least_of_rms >= 0.0;
    for (const double m : mass_kg) ok = ok && m > 0.0;
    return ok;
  }
};

/// Rows at the sampling step. The scaling coefficients of a signal are its samples, so a row is the
/// equation of motion at one sample with derivatives by the wavelet's connection coefficients.
///
/// A row comes kLatency samples after its instant, at the same cost for every sample:
/// Dof (3 kReach) multiplications and the model's regressors. Memory is fixed.
template <class Wavelet, Model M>
class MotionRows {
 public:
  static constexpr std::size_t kReach = Wavelet::kReach;
  static constexpr std::size_t kLatency = kReach + (M::kGates > 0 ? 1 : 0);
  using Config = MotionRowsConfig<M::kDof>;
  using Sample = MotionSample<M::kDof>;
  using Row = MotionRow<M>;

  /// kInvalidConfig where the step or a mass is not positive.
  [[nodiscard]] static Result<MotionRows> make(const Config& config, const M& model) noexcept {
    if (!config.valid()) return Errc::kInvalidConfig;
    return MotionRows{config, model};
  }
  MotionRows() noexcept = default;  ///< unusable until assigned

  /// Takes the next sample; true when `row` now holds the equations of the instant kLatency samples
  /// ago. Look at `row.usable` before using them.
  [[nodiscard]] bool push(const Sample& sample, Row& row) noexcept {
    for (std::size_t d = 0; d < kDof; ++d) {
      deflection_[d].push(sample.deflection_m[d]);
      force_[d].push(sample.force_n[d]);
    }
    gate_.push(model_.gates(sample.deflection_m).deflection_m);
    ++pushed_;
    if (!deflection_[0].full()) return false;
    fill(row);
    return true;
  }

  /// After a gap: what comes next does not belong to what was.
  void restart() noexcept {
    for (std::size_t d = 0; d < kDof; ++d) {
      deflection_[d].clear();
      force_[d].clear();
    }
    gate_.restart();
  }

 private:
  static constexpr auto kDof = static_cast<std::size_t>(M::kDof);

  MotionRows(const Config& config, const M& model) noexcept
      : config_{config}, model_{model}, gate_{config.gate, config.step_s} {}

  void fill(Row& row) const noexcept {
    row.sample = pushed_ - 1 - static_cast<std::int64_t>(kLatency);
    for (std::size_t d = 0; d < kDof; ++d) {
      row.deflection_m[d] = deflection_[d].back(kLatency);
      row.velocity_mps[d] = first_derivative<Wavelet>(deflection_[d], kLatency, config_.step_s);
      row.accel_mps2[d] = second_derivative<Wavelet>(deflection_[d], kLatency, config_.step_s);
      row.target_n[d] = force_[d].back(kLatency) - config_.mass_kg[d] * row.accel_mps2[d];
    }
    row.regressors = model_.regressors(row.deflection_m, row.velocity_mps);
    row.usable = true;
    if constexpr (M::kGates > 0) row.usable = gate_.clear_steps() >= 2 * kLatency;
  }

  Config config_{};
  M model_{};
  SignGate<M::kGates, M::kGateSign> gate_{{}, 1.0};
  std::array<RecentValues<double, kLatency + kReach + 1>, kDof> deflection_{};
  std::array<RecentValues<double, kLatency + 1>, kDof> force_{};
  std::int64_t pushed_{0};
};

}  // namespace dampline
