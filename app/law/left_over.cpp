// SPDX-License-Identifier: MIT
#include "app/law/left_over.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <numeric>

namespace dampline::app::law {
namespace {

constexpr std::size_t kFewestSegments = 8;
constexpr double kOfPeak = 0.01;          // of the velocity's density: where the motion is
constexpr std::size_t kBeside = 3;        // bins that the window smears
constexpr std::size_t kFewestBins = 16;   // beside the motion
constexpr std::size_t kHighestBin = 179;  // 0.35 of the rate: filters are above

}  // namespace

void LeftOver::add(double motion_m, double left_m) {
  held_[0][fill_] = motion_m;
  held_[1][fill_] = left_m;
  if (++fill_ < kSize) return;
  transform();
  for (auto& signal : held_) std::copy(signal.begin() + kSize / 2, signal.end(), signal.begin());
  fill_ = kSize / 2;
}

/// Two real signals by one complex transform.
void LeftOver::transform() {
  for (std::size_t n = 0; n < kSize; ++n) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(n) / kSize;
    fourier_.set(n, (1.0 - std::cos(angle)) * std::complex<double>{held_[0][n], held_[1][n]});
  }
  fourier_.start();
  fourier_.advance(Fourier512::kButterflies);
  for (std::size_t k = 1; k < kSize / 2; ++k) {
    const std::complex<double> a = fourier_[k];
    const std::complex<double> b = std::conj(fourier_[kSize - k]);
    motion_[k] += std::norm(a + b);
    left_[k] += std::norm(a - b);
  }
  ++segments_;
}

double LeftOver::quietest() const {
  if (segments_ < kFewestSegments) return 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = kFewestBins; k + kFewestBins <= kSize / 2; k += kFewestBins)
    least = std::min(
        least, std::accumulate(left_.begin() + static_cast<std::ptrdiff_t>(k),
                               left_.begin() + static_cast<std::ptrdiff_t>(k + kFewestBins), 0.0));
  constexpr double kOfWhite = 4.0 * 1.5 * static_cast<double>(kSize);  // of the window, in a line
  return least / (kFewestBins * kOfWhite * static_cast<double>(segments_));
}

std::optional<LeftDensity> LeftOver::density() const {
  if (segments_ < kFewestSegments) return {};
  const auto speed = [&](std::size_t k) { return static_cast<double>(k * k) * motion_[k]; };
  double peak = 0.0;
  std::size_t edge = kSize / 2 - 1;
  for (std::size_t k = 1; k <= edge; ++k) peak = std::max(peak, speed(k));
  while (edge > 1 && speed(edge) < kOfPeak * peak) --edge;
  const std::size_t beside = edge + 1 + kBeside;
  if (beside + kFewestBins > kHighestBin + 1) return {};
  const auto density = [&](std::size_t first, std::size_t end) {
    return std::accumulate(left_.begin() + static_cast<std::ptrdiff_t>(first),
                           left_.begin() + static_cast<std::ptrdiff_t>(end), 0.0) /
           static_cast<double>(end - first);
  };
  const LeftDensity out{density(1, edge + 1),
                        density((beside + kHighestBin + 1) / 2, kHighestBin + 1)};
  if (!(out.beside > 0.0)) return {};
  return out;
}

}  // namespace dampline::app::law
