// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "published/wavelet/motion_rows.hpp"

namespace dampline {

/// One step down in level: s <- h/sqrt(2) * s, every second value kept. `Channels` signals go
/// through the same filter side by side, so that an equation that held between them still holds.
template <class Wavelet, std::size_t Channels>
class CoarseDecimator {
 public:
  using Values = std::array<double, Channels>;
  static constexpr std::size_t kTaps = Wavelet::kLowPass.size();

  /// True for every second value once kTaps values are in.
  [[nodiscard]] bool push(const Values& in, Values& out) noexcept {
    recent_.push(in);
    odd_ = !odd_;
    if (!recent_.full() || odd_) return false;
    out.fill(0.0);
    for (std::size_t k = 0; k < kTaps; ++k) {
      const Values& values = recent_.back(kTaps - 1 - k);
      const double h = Wavelet::kLowPass[k] / std::numbers::sqrt2;
      for (std::size_t c = 0; c < Channels; ++c) out[c] += h * values[c];
    }
    return true;
  }

  void restart() noexcept {
    recent_.clear();
    odd_ = false;
  }

 private:
  RecentValues<Values, kTaps> recent_{};
  bool odd_{false};
};

/// Rows `Level` octaves below the sampling rate, for noisy data: deflection, force and every
/// regressor, computed on the fine grid, pass the same low-pass filters; the acceleration comes
/// from the filtered deflection at the coarse step. Usage as MotionRows; a row comes every 2^Level
/// samples, and no sample costs more than (2 + Unknowns) Dof (2N Level + 1) multiplications beside
/// those of a MotionRows. With a gate, no reversal and no stick may lie within all that a row saw.
///
/// row.sample is the first fine sample that the row's centre was filtered from; the filter delays
/// all signals alike.
template <class Wavelet, Model M, int Level>
class CoarseRows {
  static_assert(Level >= 1 && Level <= 8);

 public:
  static constexpr std::size_t kReach = Wavelet::kReach;
  static constexpr std::size_t kStride = std::size_t{1} << Level;
  /// Steps of the fine grid that a row sees, the two outermost of the gate included.
  static constexpr std::size_t kSpan = 2 * kReach * (kStride + 1) +
                                       (Wavelet::kLowPass.size() - 1) * (kStride - 1) +
                                       (M::kGates > 0 ? 2 : 0);
  using Config = MotionRowsConfig<M::kDof>;
  using Sample = MotionSample<M::kDof>;
  using Row = MotionRow<M>;

  /// kInvalidConfig where the step or a mass is not positive.
  [[nodiscard]] static Result<CoarseRows> make(const Config& config, const M& model) noexcept {
    if (!config.valid()) return Errc::kInvalidConfig;
    return CoarseRows{config, model};
  }
  CoarseRows() noexcept = default;  ///< unusable until assigned

  /// As MotionRows::push.
  [[nodiscard]] bool push(const Sample& sample, Row& row) noexcept {
    for (std::size_t d = 0; d < kDof; ++d) {
      deflection_[d].push(sample.deflection_m[d]);
      force_[d].push(sample.force_n[d]);
    }
    gate_.push(model_.gates(sample.deflection_m).deflection_m);
    ++pushed_;
    if (!deflection_[0].full()) return false;
    Values values = fine_signals();
    for (auto& decimator : decimators_) {
      const Values in = values;
      if (!decimator.push(in, values)) return false;
    }
    coarse_.push(values);
    for (std::size_t d = 0; d < kDof; ++d) coarse_deflection_[d].push(values[d]);
    if (!coarse_deflection_[0].full()) return false;
    fill(row);
    return true;
  }

  /// After a gap.
  void restart() noexcept {
    for (std::size_t d = 0; d < kDof; ++d) {
      deflection_[d].clear();
      force_[d].clear();
      coarse_deflection_[d].clear();
    }
    for (auto& decimator : decimators_) decimator.restart();
    coarse_.clear();
    gate_.restart();
  }

 private:
  static constexpr auto kDof = static_cast<std::size_t>(M::kDof);
  static constexpr auto kUnknowns = static_cast<std::size_t>(M::kUnknowns);
  static constexpr std::size_t kDelay = kReach + (M::kGates > 0 ? 1 : 0);
  // Per degree of freedom: deflection; velocity; force; regressors.
  static constexpr std::size_t kChannels = kDof * (3 + kUnknowns);
  using Values = std::array<double, kChannels>;

  CoarseRows(const Config& config, const M& model) noexcept
      : config_{config}, model_{model}, gate_{config.gate, config.step_s} {}

  [[nodiscard]] Values fine_signals() const noexcept {
    Values out{};
    PerDof<M::kDof> x{};
    PerDof<M::kDof> v{};
    for (std::size_t d = 0; d < kDof; ++d) {
      out[d] = x[d] = deflection_[d].back(kDelay);
      out[kDof + d] = v[d] = first_derivative<Wavelet>(deflection_[d], kDelay, config_.step_s);
      out[2 * kDof + d] = force_[d].back(kDelay);
    }
    const auto regressors = model_.regressors(x, v);
    for (std::size_t d = 0; d < kDof; ++d) {
      for (std::size_t i = 0; i < kUnknowns; ++i) {
        out[3 * kDof + d * kUnknowns + i] = regressors(static_cast<int>(d), static_cast<int>(i));
      }
    }
    return out;
  }

  void fill(Row& row) const noexcept {
    const double step_s = config_.step_s * static_cast<double>(kStride);
    const Values& centre = coarse_.back(kReach);
    const std::size_t newest_to_centre =
        kDelay + kReach * kStride + (Wavelet::kLowPass.size() - 1) * (kStride - 1);
    row.sample = pushed_ - 1 - static_cast<std::int64_t>(newest_to_centre);
    for (std::size_t d = 0; d < kDof; ++d) {
      row.deflection_m[d] = centre[d];
      row.velocity_mps[d] = centre[kDof + d];
      row.accel_mps2[d] = second_derivative<Wavelet>(coarse_deflection_[d], kReach, step_s);
      row.target_n[d] = centre[2 * kDof + d] - config_.mass_kg[d] * row.accel_mps2[d];
      for (std::size_t i = 0; i < kUnknowns; ++i) {
        row.regressors(static_cast<int>(d), static_cast<int>(i)) =
            centre[3 * kDof + d * kUnknowns + i];
      }
    }
    row.usable = true;
    if constexpr (M::kGates > 0) row.usable = gate_.clear_steps() >= kSpan;
  }

  Config config_{};
  M model_{};
  SignGate<M::kGates, M::kGateSign> gate_{{}, 1.0};
  std::array<RecentValues<double, kReach + kDelay + 1>, kDof> deflection_{};
  std::array<RecentValues<double, kDelay + 1>, kDof> force_{};
  std::array<CoarseDecimator<Wavelet, kChannels>, static_cast<std::size_t>(Level)> decimators_{};
  RecentValues<Values, kReach + 1> coarse_{};  // the newest to the centre of the stencil
  std::array<RecentValues<double, 2 * kReach + 1>, kDof> coarse_deflection_{};
  std::int64_t pushed_{0};
};

}  // namespace dampline
