// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "dampline/numeric/wide.hpp"
#include "dampline/sample.hpp"

namespace dampline {

/// The sensors' anti-aliasing filters: Butterworth low passes, alike but for corners of their own.
struct AntiAliasConfig {
  double corner_hz{100.0};  ///< -3 dB; 0: none, or unknown
  int order{4};             ///< 1...8
  /// The samples come of a Decimator: nothing is folded into them, and nothing but its edge is
  /// above kThinnedEdge of their rate.
  bool thinned{false};
  /// By Channel, where a sensor's corner is another; 0: it is not. Of no use where corner_hz is 0.
  std::array<double, kChannels> own_hz{};

  /// That of one channel; beyond the three, of an extra sensor.
  [[nodiscard]] AntiAliasConfig of(std::size_t channel) const noexcept {
    const bool has_own = corner_hz > 0.0 && channel < kChannels && own_hz[channel] > 0.0;
    return {has_own ? own_hz[channel] : corner_hz, order, thinned};
  }
  [[nodiscard]] bool is_usable() const noexcept {
    const auto usable = [](double hz) { return hz >= 0.0 && std::isfinite(hz); };
    return usable(corner_hz) && std::all_of(own_hz.begin(), own_hz.end(), usable) && order >= 1 &&
           order <= 8;
  }
};
inline constexpr double kThinnedEdge = 0.455;

/// What a Butterworth low pass divides a power by, at `relative` times its corner.
[[nodiscard]] inline double butterworth_loss(double relative, int order) noexcept {
  return 1.0 + std::pow(relative, 2 * order);
}

/// By how much it delays what is slow.
[[nodiscard]] inline double delay_s(const AntiAliasConfig& filter) noexcept {
  constexpr double kPi = 3.141592653589793238;
  return 1.0 / (2.0 * kPi * filter.corner_hz * std::sin(kPi / (2.0 * filter.order)));
}

/// The power of an acceleration that falls as 1 / f, up to a factor, behind the filter.
[[nodiscard]] inline double passed_power(const AntiAliasConfig& filter, double hz) noexcept {
  const bool known = filter.corner_hz > 0.0;
  const double passed = known ? 1.0 / butterworth_loss(hz / filter.corner_hz, filter.order) : 1.0;
  return passed / (hz * hz);
}
/// That of friction's leaps, as they are sampled: with what is folded into it.
[[nodiscard]] inline double leap_power(const AntiAliasConfig& filter, double f_hz,
                                       double sample_rate_hz) noexcept {
  return passed_power(filter, f_hz) +
         (filter.thinned ? 0.0 : passed_power(filter, sample_rate_hz - f_hz));
}

/// Noise beside what is folded: a constant and a multiple of a shape, by weighted least squares.
struct WhiteAndFolded {
  static constexpr double kTiny = 1e-300;
  double w{0.0}, wg{0.0}, wgg{0.0}, wy{0.0}, wgy{0.0};
  void add(double weight, double shape, double value) noexcept {
    w += weight;
    wg += weight * shape;
    wgg += weight * shape * shape;
    wy += weight * value;
    wgy += weight * shape * value;
  }
  [[nodiscard]] double determinant() const noexcept { return w * wgg - wg * wg; }
  /// 0 where they cannot be told apart.
  [[nodiscard]] double constant() const noexcept {
    return (wgg * wy - wg * wgy) / (determinant() + kTiny);
  }
  [[nodiscard]] double multiple() const noexcept {
    return (w * wgy - wg * wy) / (determinant() + kTiny);
  }
  /// At least 0.
  [[nodiscard]] double white() const noexcept { return std::fmax(constant(), 0.0); }
  /// Weighted mean of the values.
  [[nodiscard]] double mean() const noexcept { return wy / (w + kTiny); }
};

/// A short filter that lifts the fast part of the velocity which the anti-aliasing filter has
/// lowered, by a share of the loss in decibels, up to the corner: 60 % at 100 Hz, 75 % where
/// nothing is folded, more below, all of it and a little more from 76 Hz down, since wheelsets
/// shake most between 45 and 75 Hz.
///
/// What is linear in the accelerations commutes with the anti-aliasing filter and needs nothing;
/// friction does not. Left alone, sign(v) of a velocity without its fast part puts the friction
/// level 0.1 to 1.2 % low (100 Hz at 300 samples a second); lifted by the whole loss, up to 0.7 %
/// high. Phase is left as it is at 100 Hz: undoing it biases stiffness by 0.5 to 2 %, because the
/// filter's delay of fast parts offsets the delay that smoothing gives to the kinks of v at its
/// reversals. Of what a lower filter delays them beyond that, 80 % are undone; left alone it puts
/// the spring 1.5 % too stiff at 60 Hz.
/// Figures and method: docs/adr/0003-anti-alias.md, docs/adr/0024-low-corners.md.
class VelocityLift {
 public:
  static constexpr int kHalf = 12;
  static double share_of_loss(const AntiAliasConfig& filter) noexcept;  ///< of the decibels
  using Taps = std::array<double, 2 * kHalf + 1>;

  VelocityLift(const AntiAliasConfig& config, double sample_rate_hz) noexcept;
  [[nodiscard]] const Taps& taps() const noexcept { return taps_; }

 private:
  Taps taps_{};
};

/// Finite impulse response of 2 Half + 1 taps around the centre; the output is Half samples late.
template <int Half>
class Fir {
 public:
  static constexpr int kDelay = Half;
  static constexpr std::size_t kTaps = 2 * Half + 1;

  /// Tap k of -Half...Half weighs the sample k before the centre.
  explicit Fir(const std::array<double, kTaps>& taps) noexcept {
    for (std::size_t i = 0; i < kTaps; ++i) taps_[i] = taps[kTaps - 1 - i];
  }

  /// Takes x_n. True when `out` was set to the filtered x_(n-Half).
  bool update(double x, double& out) noexcept {
    window_.push(x);
    if (seen_ < kTaps && ++seen_ < kTaps) return false;
    out = window_.dot(taps_);
    return true;
  }

  void reset() noexcept { seen_ = 0; }

 private:
  std::array<double, kTaps> taps_{};  // of the oldest value first
  SlidingWindow<kTaps> window_{};
  std::size_t seen_{0};
};

}  // namespace dampline
