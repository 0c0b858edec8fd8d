// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>

#include "dampline/numeric/log_histogram.hpp"
#include "dampline/rig/config.hpp"
#include "dampline/rig/motion.hpp"

namespace dampline::rig {

/// The fourth difference about 0 of `at(j)`, j = -2 ... 2.
template <class At>
[[nodiscard]] constexpr double fourth_difference(const At& at) noexcept {
  return at(-2) + at(2) - 4.0 * (at(-1) + at(1)) + 6.0 * at(0);
}

/// The eighth difference about 0 of `at(j)`, j = -4 ... 4.
template <class At>
[[nodiscard]] constexpr double eighth_difference(const At& at) noexcept {
  return at(-4) + at(4) - 8.0 * (at(-3) + at(3)) + 28.0 * (at(-2) + at(2)) -
         56.0 * (at(-1) + at(1)) + 70.0 * at(0);
}

/// Standard deviation of Gaussian white noise of which the median of |fourth difference| is known:
/// the median of |x| over sigma, times the gain sqrt(70). Jumps and curves of what is measured do
/// not count.
[[nodiscard]] constexpr double sigma_of_fourth(double median) noexcept {
  return median / (0.67449 * 8.36660);
}

/// The same from fourth and eighth differences (gain sqrt(12870)). Where the eighth have clearly
/// less, there is motion in the fourth.
[[nodiscard]] constexpr double white_sigma(double median_fourth, double median_eighth) noexcept {
  constexpr double kOfMotion = 0.8;
  const double fourth = sigma_of_fourth(median_fourth);
  const double eighth = median_eighth / (0.67449 * 113.4460);
  return eighth < kOfMotion * fourth ? eighth : fourth;
}

/// A first look at a record: how fast, how noisy, how long. Decides the settings of the
/// Identifier that a person need not.
class Survey {
 public:
  explicit Survey(double sample_rate_hz, bool velocity_measured) noexcept
      : rate_hz_{sample_rate_hz}, velocity_measured_{velocity_measured} {}

  void update(const Sample& sample) noexcept;

  /// Settings with
  ///  - corner: a fiftieth of the rate, or four times the motion's own frequency where that is more
  ///    (two thirteenths of the rate at most), then lower by half octaves until noise makes less
  ///    than a thousandth of the variance of <x, psi''>, the column of a driven mass;
  ///  - prediction corner: by the same rule from a twelfth of the rate, not below the corner;
  ///  - derivative of the deflection: as short as noise of 1 % of the rms velocity permits, because
  ///    a longer one shifts the reversals, a quarter of the test function at most; sixth-order
  ///    differences where a difference over two samples would lose 0.2 % of the mean square;
  ///  - sign width: 1.2533 standard deviations of the velocity error (E[sign v | measured v]);
  ///  - standstill: three of those, or 1 % of the rms velocity;
  ///  - nodes: eight equal segments up to the 99 % quantile of |v|;
  ///  - blocks: about 80 in the record, at least two test functions long.
  /// kNotReady where there is no motion; kInvalidConfig where the corner that was asked for does
  /// not fit the rate. `corner_hz` 0: chosen as above.
  [[nodiscard]] Result<Config> suggest(const Terms& terms, double corner_hz = 0.0) const noexcept;

  /// White noise of the deflection, rms, from fourth differences, or from eighth ones where those
  /// show that the motion itself is in the fourth; at least that of its resolution.
  [[nodiscard]] double deflection_noise_m() const noexcept;
  [[nodiscard]] std::uint64_t samples() const noexcept { return samples_; }
  /// sqrt of mean v^2 / variance of x, in Hz: the frequency of a harmonic motion.
  [[nodiscard]] double motion_frequency_hz() const noexcept;

 private:
  static constexpr std::size_t kRing = 17;
  static constexpr std::size_t kSpans = 5;  ///< differences over 1, 2, 4, 8 and 16 samples

  void take_differences() noexcept;
  void take_speed(std::size_t span, double velocity_mps) noexcept;
  [[nodiscard]] double mean_square_mps2(std::size_t span) const noexcept;
  [[nodiscard]] double signal_mps2(std::size_t span) const noexcept;
  [[nodiscard]] std::size_t longest_faithful_span() const noexcept;
  [[nodiscard]] const Sample& ago(std::size_t samples) const noexcept;
  [[nodiscard]] double choose_corner_hz(const Terms& terms) const noexcept;
  [[nodiscard]] double quiet_corner_hz(double highest_hz, double lowest_hz) const noexcept;
  [[nodiscard]] double velocity_rms_mps() const noexcept;
  [[nodiscard]] double derivative_error_mps(int half_width) const noexcept;
  [[nodiscard]] bool wants_sharp_velocity() const noexcept;
  [[nodiscard]] int choose_half_width(const Config& config) const noexcept;
  [[nodiscard]] double velocity_error_mps(const Config& config) const noexcept;

  double rate_hz_;
  bool velocity_measured_;
  std::array<Sample, kRing> ring_{};
  std::size_t next_{0};
  std::size_t run_{0};  ///< consecutive samples in the ring
  std::uint64_t samples_{0};
  std::uint64_t velocities_{0};
  double mean_m_{0.0};
  double squares_m2_{0.0};
  std::array<double, kSpans> velocity_squares_{};
  double resolution_m_{0.0};  ///< smallest step other than 0
  std::array<LogHistogram, kSpans> speed_mps_;
  LogHistogram deflection_fourth_m_;
  LogHistogram deflection_eighth_m_;
  LogHistogram velocity_fourth_mps_;
};

}  // namespace dampline::rig
