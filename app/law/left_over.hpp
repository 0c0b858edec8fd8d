// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <optional>

#include "dampline/numeric/fourier.hpp"

namespace dampline::app::law {

/// Mean density of what is left, by its place; in one unit.
struct LeftDensity {
  double within;  ///< where the motion is
  double beside;
  [[nodiscard]] double ratio() const noexcept { return within / beside; }
  [[nodiscard]] double excess() const noexcept { return within - beside; }
};

/// Whether what a law leaves of a motion is more than noise: spectra of both, segments of 512
/// samples with a Hann window, half overlapping (Welch 1967). Noise is as dense beside the motion
/// as where the motion is; what a law misses lies where the motion is.
class LeftOver {
 public:
  /// The next sample of the motion as the law has it, and of what it leaves.
  void add(double motion_m, double left_m);
  /// The next sample does not follow the last one.
  void gap() noexcept { fill_ = 0; }
  /// Absent where too little lies beside the motion, or the record is too short.
  [[nodiscard]] std::optional<LeftDensity> density() const;
  /// Variance of the white noise that is as dense as what is left in the quietest sixteen
  /// neighbouring lines of its spectrum: no more noise is in it. 0: the record is too short.
  [[nodiscard]] double quietest() const;

 private:
  static constexpr std::size_t kSize = Fourier512::kSize;
  void transform();

  std::array<std::array<double, kSize>, 2> held_{};
  std::size_t fill_{0};
  Fourier512 fourier_;
  std::size_t segments_{0};
  std::array<double, kSize / 2> motion_{};
  std::array<double, kSize / 2> left_{};
};

}  // namespace dampline::app::law
