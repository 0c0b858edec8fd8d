// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <span>
#include <type_traits>

namespace dampline {

/// Octave scales of the bank: 2, 4, 8, 16 and 32 Hz at 300 samples a second.
inline constexpr std::size_t kScales = 5;

/// Compact test functions with four vanishing moments at octave scales, and the derivatives that
/// integration by parts needs. With B(u) = (1 - u^2)^8, u = n / (half + 1), tau = (half + 1) h:
///
///   psi = B'''' / tau^4,  psi1 = B''' / tau^3,  Psi = B'' / tau^2,   psi = psi1' = Psi''
///
///   <psi, y> = <Psi, y''>,   <psi, y'> = -<psi1, y''>
///
/// so displacement and velocity enter a row through measured accelerations alone: nothing is
/// integrated, and a constant or a linear drift of a sensor drops out. The tables of a scale share
/// one normalisation, sum psi^2 = 1. |Fourier transform of psi| peaks at 1.245 / ((half + 1) h) Hz:
/// at 1.8 Hz for the scale that is named 2 Hz, and so on.
///
/// The `lumped` tables are convolved with [1 10 1] / 12: applied to samples they match, to fourth
/// order, the average by the hat function that the friction law goes through (LawAverage). They
/// reach one sample further on each side.
///
/// Number: of the tables. In single precision psi is kept once, from the end to the centre.
template <class Number, int kMostHz>
class BasicWindowBank {
 public:
  static constexpr bool kHasPsi = std::is_same_v<Number, double>;
  static constexpr double kMaxRateHz = kMostHz;
  static constexpr double kHalfSupportS = 208.0 / 300.0;  ///< of the 2 Hz scale
  static constexpr int kMaxHalf = static_cast<int>(kHalfSupportS * kMostHz) + 1;

  /// `sample_rate_hz` at most kMaxRateHz.
  explicit BasicWindowBank(double sample_rate_hz) noexcept;

  /// Samples on each side of the centre.
  [[nodiscard]] int half(std::size_t scale) const noexcept { return windows_[scale].half; }
  /// Samples between the centres of consecutive rows.
  [[nodiscard]] int stride(std::size_t scale) const noexcept { return windows_[scale].stride; }

  /// psi at -half...half.
  [[nodiscard]] std::span<const double> psi(std::size_t scale) const noexcept requires(kHasPsi) {
    return std::span{psi_}.subspan(windows_[scale].start + 1, taps(scale));
  }
  /// The same in single precision, from the end to the centre: psi is even.
  [[nodiscard]] const float* half_psi(std::size_t scale) const noexcept {
    return &half_psi_[windows_[scale].start / 2];
  }
  /// Sum of |psi|.
  [[nodiscard]] double mass(std::size_t scale) const noexcept { return windows_[scale].mass; }

  /// Share of the window's mass on marked samples. `marks` is a ring, 1 where a sample is marked
  /// and 0 elsewhere; `first` is the place of the window's first sample in it.
  template <std::size_t Ring>
  [[nodiscard]] double marked_share(std::size_t scale, const std::array<float, Ring>& marks,
                                    std::size_t first) const noexcept {
    double sum = 0.0;
    const int half = windows_[scale].half;
    for (int n = -half; n <= half; ++n) {
      sum += std::abs(psi_at(scale, n)) * static_cast<double>(marks[first]);
      if (++first == Ring) first = 0;
    }
    return sum / mass(scale);
  }

  /// The lumped tables at -half-1...half+1.
  [[nodiscard]] std::span<const Number> lumped_psi(std::size_t scale) const noexcept {
    return lumped(lumped_psi_, scale);
  }
  [[nodiscard]] std::span<const Number> lumped_psi1(std::size_t scale) const noexcept {
    return lumped(lumped_psi1_, scale);
  }
  [[nodiscard]] std::span<const Number> lumped_double_integral(std::size_t scale) const noexcept {
    return lumped(lumped_double_integral_, scale);
  }

 private:
  struct Window {
    std::size_t start{0};
    int half{0};
    int stride{0};
    double mass{0.0};
  };
  // At least the sum of 2 half + 3 at the highest rate.
  static constexpr std::size_t kArena = 27 * std::size_t{kMostHz} / 10 + 24;
  using Table = std::array<Number, kArena>;

  /// -half <= n <= half.
  [[nodiscard]] double psi_at(std::size_t scale, int n) const noexcept {
    const Window& window = windows_[scale];
    if constexpr (kHasPsi)
      return psi_[window.start + static_cast<std::size_t>(n + window.half + 1)];
    else
      return half_psi(scale)[window.half - std::abs(n)];
  }

  [[nodiscard]] std::size_t taps(std::size_t scale) const noexcept {
    return 2 * static_cast<std::size_t>(windows_[scale].half) + 1;
  }
  [[nodiscard]] std::span<const Number> lumped(const Table& table,
                                               std::size_t scale) const noexcept {
    return std::span{table}.subspan(windows_[scale].start, taps(scale) + 2);
  }
  void fill(Window& window, double step_s) noexcept;

  std::array<Window, kScales> windows_{};
  std::array<double, kHasPsi ? kArena : 0> psi_{};
  std::array<float, kArena / 2> half_psi_{};
  Table lumped_psi_{};
  Table lumped_psi1_{};
  Table lumped_double_integral_{};
};

using WindowBank = BasicWindowBank<double, 400>;

}  // namespace dampline
