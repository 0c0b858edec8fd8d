// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>

namespace dampline {

/// A complex Fourier transform of 512 points, X_k = sum x_n e^(-2 pi i k n / N), radix 2 with
/// decimation in time, done in as many calls as wanted so that no sample pays for all of it.
class Fourier512 {
 public:
  static constexpr std::size_t kSize = 512;
  static constexpr std::size_t kStages = 9;
  static constexpr std::size_t kButterflies = kStages * kSize / 2;
  using Complex = std::complex<double>;

  /// Point n of the input. All points must be set before advance().
  void set(std::size_t n, Complex x) noexcept { x_[reversed(n)] = x; }
  /// Begins a transform of what was set.
  void start() noexcept { done_ = 0; }
  /// The next `butterflies` of kButterflies; true when all are done.
  bool advance(std::size_t butterflies) noexcept;
  [[nodiscard]] const Complex& operator[](std::size_t k) const noexcept { return x_[k]; }

  /// e^(-2 pi i k / 512), k below 256.
  [[nodiscard]] static Complex turn(std::size_t k) noexcept;

 private:
  [[nodiscard]] static constexpr std::size_t reversed(std::size_t n) noexcept {
    std::size_t r = 0;
    for (std::size_t i = 0; i < kStages; ++i) r |= ((n >> i) & 1U) << (kStages - 1 - i);
    return r;
  }
  std::array<Complex, kSize> x_{};
  std::size_t done_{0};
};

/// Radians, -pi ... pi. The complex library's own is a call that a microcontroller may lack.
[[nodiscard]] inline double phase_of(const std::complex<double>& z) noexcept {
  return std::atan2(z.imag(), z.real());
}

}  // namespace dampline
