// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "published/oscillator/flat_integral.hpp"
#include "published/oscillator/gram_polynomials.hpp"

namespace dampline {

/// Velocity and deflection of the block in the middle of a window, from the acceleration by two
/// running integrals less their least-squares polynomials of degree kSlow - 1 over the window. A
/// bias, a linear drift of the sensors and the unknown motion at the start are polynomials of
/// degree three at most and vanish exactly. What is lost of the motion itself is a polynomial, too:
/// the block's rows have columns for it (BlockRows).
///
/// Every step below is one sample's work; they are called in order for all i.
template <int Block, int Guard>
class DriftFreeWindow {
 public:
  static constexpr int kSlow = 8;
  static constexpr int kLength = Block + 2 * Guard;
  static constexpr int kReach = FlatIntegral::kReach;
  static constexpr int kBefore = 2 * kReach;     ///< samples needed before the window
  static constexpr int kAfter = 2 * kReach - 2;  ///< and behind it
  static constexpr int kVelocitySteps = kLength + 2 * kReach;
  static constexpr int kDeflectionSteps = kLength;
  using Slow = GramPolynomials<kSlow, kLength>;

  void clear() noexcept {
    velocity_trend_ = deflection_trend_ = {};
    square_ = 0.0;
    deflection_square_ = 0.0;
  }

  /// Velocity of sample i - kReach of the window; `relative(j)` is the acceleration of sample j.
  template <class At>
  void integrate_velocity(int i, double step_s, const At& relative) noexcept {
    const double before = i == 0 ? 0.0 : velocity_[index(i - 1)];
    const int n = i - kReach;
    const double now = before + step_s * FlatIntegral::over_step(n, relative);
    velocity_[index(i)] = now;
    if (n >= 0 && n < kLength) add(velocity_trend_, n, now);
  }

  /// Deflection of sample i of the window.
  void integrate_deflection(int i, double step_s) noexcept {
    const double before = i == 0 ? 0.0 : deflection_[index(i - 1)];
    const double now =
        before + step_s * FlatIntegral::over_step(i, [this](long j) { return raw_velocity(j); });
    deflection_[index(i)] = now;
    add(deflection_trend_, i, now);
  }

  /// Sample i of the block becomes free of drift.
  void remove_drift(int i) noexcept {
    const auto slow = slow_.at(i + Guard);
    double& v = velocity_[index(i + Guard + kReach)];
    double& x = deflection_[index(i + Guard)];
    v -= Slow::sum(velocity_trend_, slow);
    x -= Slow::sum(deflection_trend_, slow);
    square_ += v * v;
    deflection_square_ += x * x;
  }

  /// Of sample i of the block, after remove_drift().
  [[nodiscard]] double velocity_mps(int i) const noexcept {
    return velocity_[index(i + Guard + kReach)];
  }
  [[nodiscard]] double deflection_m(int i) const noexcept { return deflection_[index(i + Guard)]; }
  void shift_deflection(int i, double by_m) noexcept { deflection_[index(i + Guard)] += by_m; }

  [[nodiscard]] double velocity_rms_mps() const noexcept { return std::sqrt(square_ / Block); }
  /// Sum of squares over the block.
  [[nodiscard]] double deflection_square_m2() const noexcept { return deflection_square_; }

 private:
  static constexpr std::size_t index(int i) noexcept { return static_cast<std::size_t>(i); }
  [[nodiscard]] double raw_velocity(long j) const noexcept {
    return velocity_[static_cast<std::size_t>(j + kReach)];
  }
  void add(typename Slow::Values& trend, int i, double x) noexcept {
    const auto slow = slow_.at(i);
    for (std::size_t j = 0; j < slow.size(); ++j) trend[j] += slow[j] * x;
  }

  Slow slow_;
  std::array<double, static_cast<std::size_t>(kVelocitySteps)> velocity_{};
  std::array<double, static_cast<std::size_t>(kDeflectionSteps)> deflection_{};
  typename Slow::Values velocity_trend_{};
  typename Slow::Values deflection_trend_{};
  double square_{0.0};
  double deflection_square_{0.0};
};

}  // namespace dampline
