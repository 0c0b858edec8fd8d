// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "dampline/numeric/information.hpp"
#include "dampline/result.hpp"
#include "published/wavelet/daubechies.hpp"
#include "published/wavelet/models.hpp"

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

/// The latest `Size` values. back(0) is the newest.
template <class T, std::size_t Size>
class RecentValues {
 public:
  void push(const T& value) noexcept {
    newest_ = newest_ + 1 == Size ? 0 : newest_ + 1;
    values_[newest_] = value;
    if (count_ < Size) ++count_;
  }
  [[nodiscard]] const T& back(std::size_t age) const noexcept {
    return values_[newest_ >= age ? newest_ - age : newest_ + Size - age];
  }
  [[nodiscard]] bool full() const noexcept { return count_ == Size; }
  void clear() noexcept { count_ = 0; }

 private:
  std::array<T, Size> values_{};
  std::size_t newest_{0};
  std::size_t count_{0};
};

/// Rate of change at the sample `age` steps ago: 1/D sum_k Gamma1_k (s_(+k) - s_(-k)).
/// Needs kReach samples on each side. kReach multiplications.
template <class Wavelet, std::size_t Size>
[[nodiscard]] double first_derivative(const RecentValues<double, Size>& samples, std::size_t age,
                                      double step) noexcept {
  double sum = 0.0;
  for (std::size_t k = Wavelet::kReach; k > 0; --k) {
    sum += Wavelet::kFirst[k] * (samples.back(age - k) - samples.back(age + k));
  }
  return sum / step;
}

/// Second derivative at the sample `age` steps ago. The constant part drops out before anything is
/// multiplied: 1/D^2 sum_k Gamma2_k (s_(+k) - 2 s_0 + s_(-k)), since the coefficients sum to zero.
template <class Wavelet, std::size_t Size>
[[nodiscard]] double second_derivative(const RecentValues<double, Size>& samples, std::size_t age,
                                       double step) noexcept {
  const double centre = samples.back(age);
  double sum = 0.0;
  for (std::size_t k = Wavelet::kReach; k > 0; --k) {
    sum +=
        Wavelet::kSecond[k] * ((samples.back(age - k) - centre) + (samples.back(age + k) - centre));
  }
  return sum / (step * step);
}

/// When a gate lets a row through.
struct GateConfig {
  double least_speed_mps{0.0};  ///< slower than this counts as at rest
  double least_of_rms{0.02};    ///< so does slower than this share of the running rms speed
};

/// Watches deflections for stretches without reversal or stick: a row is usable when each watched
/// deflection moved one way, faster than the limit, during every step that its stencil touches and
/// one more on each side, so that no kink can lie within. With `WatchSign` its own sign must not
/// change either. The speed of a step is its increment over its length: unlike a derivative from a
/// stencil it is not blurred by a reversal nearby, and needs no samples from beyond the stencil.
///
/// Constant time: one run length per deflection.
template <int Count, bool WatchSign>
class SignGate {
 public:
  static constexpr std::size_t kCount = static_cast<std::size_t>(Count);
  using Values = std::array<double, kCount>;

  SignGate(const GateConfig& config, double step_s) noexcept : config_{config}, step_s_{step_s} {}

  void push(const Values& deflection_m) noexcept {
    if (!has_last_) {
      last_m_ = deflection_m;
      has_last_ = true;
      return;
    }
    ++steps_;
    for (std::size_t i = 0; i < kCount; ++i) update(i, deflection_m[i]);
    last_m_ = deflection_m;
  }

  /// Steps since a watched deflection last reversed, stood still or changed its sign.
  [[nodiscard]] std::size_t clear_steps() const noexcept {
    std::size_t least = run_[0];
    for (const std::size_t run : run_) least = run < least ? run : least;
    return least;
  }

  /// After a gap. The running rms is kept.
  void restart() noexcept {
    has_last_ = false;
    run_.fill(0);
  }

 private:
  void update(std::size_t i, double deflection_m) noexcept {
    const double speed_mps = (deflection_m - last_m_[i]) / step_s_;
    sum_squares_[i] += speed_mps * speed_mps;
    const double rms_mps = std::sqrt(sum_squares_[i] / static_cast<double>(steps_));
    const bool moves = std::abs(speed_mps) > config_.least_speed_mps &&
                       std::abs(speed_mps) > config_.least_of_rms * rms_mps;
    const bool forward = speed_mps > 0.0;
    const bool same_way = forward == forward_[i];
    const bool same_side = !WatchSign || deflection_m * last_m_[i] > 0.0;
    // A reversal: the step itself goes the new way and is the first of the next stretch.
    run_[i] = !(moves && same_side) ? 0 : (same_way ? run_[i] + 1 : 1);
    forward_[i] = forward;
  }

  GateConfig config_;
  double step_s_;
  Values last_m_{};
  Values sum_squares_{};
  std::array<bool, kCount> forward_{};
  std::array<std::size_t, kCount> run_{};
  std::size_t steps_{0};
  bool has_last_{false};
};

/// For smooth models: everything passes.
template <bool WatchSign>
class SignGate<0, WatchSign> {
 public:
  using Values = std::array<double, 0>;
  SignGate(const GateConfig& /*config*/, double /*step_s*/) noexcept {}
  void push(const Values& /*deflection_m*/) noexcept {}
  void restart() noexcept {}
};

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
