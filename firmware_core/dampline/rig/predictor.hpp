// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>

#include "dampline/rig/columns.hpp"
#include "dampline/rig/fit.hpp"
#include "dampline/rig/motion.hpp"

namespace dampline::rig {

/// Force of one instant: measured, and as the model makes it from the measured motion alone.
struct Prediction {
  std::int64_t tick{0};
  double deflection_m{0.0};
  double velocity_mps{0.0};
  double measured_n{0.0};
  double fitted_n{0.0};
  double held_out_n{0.0};  ///< by the fit without the fold that holds this instant
};

/// nmse = sum (f - f_hat)^2 / (N var f), in time, against the raw measured force.
struct Errors {
  std::uint64_t samples{0};
  double nmse{0.0};
  double held_out_nmse{0.0};
};

/// Predicts a record's force sample by sample. Only a driven mass needs the acceleration: it is
/// seen through the test function, <x, psi''>; everything else is of the instant.
class Predictor {
 public:
  /// `block_samples` as Identifier::block_samples() when `solution` was made.
  Predictor(const Config& config, const Solution& solution, std::int64_t block_samples) noexcept;

  /// True when `out` was filled, with an instant of latency ago. Gaps and values that are no number
  /// restart, as in Identifier.
  bool update(const Sample& sample, Prediction& out) noexcept;
  [[nodiscard]] Errors errors() const noexcept;

 private:
  static constexpr int kRing = 2 * kMaxHalfSupport + 1;

  [[nodiscard]] const Motion& ago(int samples) const noexcept;
  [[nodiscard]] double acceleration_mps2() const noexcept;
  [[nodiscard]] Prediction predict(const Motion& motion) const noexcept;
  void count(const Prediction& prediction) noexcept;

  Config config_;
  Solution solution_;
  std::int64_t block_samples_;
  MotionEstimator motion_;
  Regressors regressors_;
  TestFunction psi_;
  int delay_;  ///< samples from newest motion to the centre: half the support, or 0
  std::array<Motion, kRing> ring_{};
  int next_{0};
  int seen_{0};
  bool started_{false};
  std::int64_t first_tick_{0};
  std::int64_t last_tick_{0};
  Errors sums_;
  double mean_n_{0.0};
  double squares_n2_{0.0};
};

}  // namespace dampline::rig
