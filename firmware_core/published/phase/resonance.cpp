// SPDX-License-Identifier: MIT
#include "published/phase/resonance.hpp"

#include <algorithm>
#include <cmath>

namespace dampline {

void ResonanceFit::add(double rate_rad_s, double amplitude) noexcept {
  if (!std::isfinite(rate_rad_s) || !std::isfinite(amplitude) || !(rate_rad_s > 0.0)) return;
  lowest_ = count_ == 0 ? rate_rad_s : std::min(lowest_, rate_rad_s);
  highest_ = count_ == 0 ? rate_rad_s : std::max(highest_, rate_rad_s);
  ++count_;
  if (!(amplitude > 0.0)) {
    still_ = true;
    return;
  }
  const double x = rate_rad_s * rate_rad_s;
  const double weight = amplitude * amplitude;  // the same relative error at every frequency
  Information<4>::Row row;
  row << weight, weight * x, weight * x * x, 1.0;
  factor_.absorb(row);
}

Resonance ResonanceFit::resonance() const noexcept {
  Resonance out;
  if (count_ < 4) return out;
  out.state = ResonanceState::kNoMotion;
  if (still_) return out;
  out.state = ResonanceState::kNoPeak;
  Information<4>::Vector p;
  if (!factor_.solve(p) || !(p[2] > 0.0)) return out;
  const double square = -p[1] / (2.0 * p[2]);
  if (!(square > lowest_ * lowest_) || !(square < highest_ * highest_)) return out;
  const double rate = std::sqrt(square);
  const double variance =
      factor_.residual_norm() * factor_.residual_norm() / std::max(count_ - 3, 1);
  const auto covariance = factor_.inverse();
  const Information<4>::Vector slope{0.0, -0.5 / p[2] / (2.0 * rate),
                                     -square / p[2] / (2.0 * rate)};
  double sum = 0.0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum += slope[i] * covariance(i, j) * slope[j];
  out.state = ResonanceState::kFound;
  out.rate_rad_s = {rate, std::sqrt(variance * sum)};
  return out;
}

}  // namespace dampline
