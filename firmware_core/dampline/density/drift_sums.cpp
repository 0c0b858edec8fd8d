// SPDX-License-Identifier: MIT
#include "dampline/density/drift_sums.hpp"

namespace dampline {

void DriftMoments::add(const DriftMoments& other, double factor) noexcept {
  n += factor * other.n;
  u += factor * other.u;
  uu += factor * other.uu;
  y += factor * other.y;
  uy += factor * other.uy;
  a += factor * other.a;
  ua += factor * other.ua;
}

DriftBins::DriftBins(const std::array<double, kCurveSegments>& curve_nodes_mps) noexcept {
  nodes_[1] = 0.5 * curve_nodes_mps[0];
  for (std::size_t i = 0; i < kCurveSegments; ++i) nodes_[i + 2] = curve_nodes_mps[i];
  for (std::size_t i = 0; i < kPerSide; ++i) per_width_[i] = 1.0 / (nodes_[i + 1] - nodes_[i]);
}

void DriftSums::add(const DriftSums& other, double factor) noexcept {
  for (std::size_t s = 0; s < 2; ++s) {
    for (std::size_t b = 0; b < DriftBins::kPerSide; ++b) {
      sides[s][b].add(other.sides[s][b], factor);
    }
  }
}

void DriftSums::scale(double factor) noexcept {
  DriftSums scaled;
  scaled.add(*this, factor);
  *this = scaled;
}

double DriftSums::count() const noexcept {
  double sum = 0.0;
  for (const auto& side : sides) {
    for (const DriftMoments& m : side) sum += m.n;
  }
  return sum;
}

}  // namespace dampline
