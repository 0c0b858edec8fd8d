// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace dampline {

/// Integral over one step from ten samples, five on each side of its middle: the interpolating
/// polynomial of degree nine, integrated. Its gain is that of an integrator to 3e-6 up to a tenth
/// of the sampling rate and to 0.1 % up to a fifth. (ShortIntegral reaches further and errs by 2e-4
/// low down, where a spring would take it for stiffness.)
struct FlatIntegral {
  static constexpr int kReach = 5;
  /// Weights of the samples 1/2, 3/2... steps from the middle of the step; they sum to one half.
  static constexpr std::array<double, kReach> kWeights{4134338.0 / 7257600.0, -641776.0 / 7257600.0,
                                                       162680.0 / 7257600.0, -28939.0 / 7257600.0,
                                                       2497.0 / 7257600.0};

  /// From sample i - 1 to sample i, in steps; `at(j)` gives sample j, for i - 5 <= j <= i + 4.
  template <class At>
  [[nodiscard]] static double over_step(long i, const At& at) noexcept {
    double sum = 0.0;
    for (int j = 0; j < kReach; ++j) {
      sum += kWeights[static_cast<std::size_t>(j)] * (at(i + j) + at(i - 1 - j));
    }
    return sum;
  }
};

/// Polynomials of degree 0...Count - 1, orthonormal over N equally spaced points (Gram; also
/// discrete Legendre or Chebyshev polynomials). With x = i - (N - 1) / 2,
///   b_(j+1) p_(j+1) = x p_j - b_j p_(j-1),   b_j^2 = j^2 (N^2 - j^2) / (4 (4 j^2 - 1)).
template <int Count, int N>
class GramPolynomials {
  static_assert(Count >= 1 && N > Count);

 public:
  using Values = std::array<double, static_cast<std::size_t>(Count)>;

  GramPolynomials() noexcept {
    for (std::size_t j = 1; j < b_.size(); ++j) {
      const double square = static_cast<double>(j) * static_cast<double>(j);
      b_[j] =
          std::sqrt(square * (static_cast<double>(N) * N - square) / (4.0 * (4.0 * square - 1.0)));
    }
  }

  /// All of them at point i, 0 <= i < N.
  [[nodiscard]] Values at(int i) const noexcept {
    const double x = i - 0.5 * (N - 1);
    Values p{};
    p[0] = 1.0 / std::sqrt(static_cast<double>(N));
    if constexpr (Count > 1) p[1] = x * p[0] / b_[1];
    for (std::size_t j = 2; j < p.size(); ++j) p[j] = (x * p[j - 1] - b_[j - 1] * p[j - 2]) / b_[j];
    return p;
  }

  /// sum_j c_j p_j.
  [[nodiscard]] static double sum(const Values& coefficients, const Values& at) noexcept {
    double out = 0.0;
    for (std::size_t j = 0; j < at.size(); ++j) out += coefficients[j] * at[j];
    return out;
  }

 private:
  Values b_{};
};

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
