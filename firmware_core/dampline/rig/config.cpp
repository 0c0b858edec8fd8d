// SPDX-License-Identifier: MIT
#include "dampline/rig/config.hpp"

#include <algorithm>
#include <cmath>

#include "dampline/rig/columns.hpp"

namespace dampline::rig {
namespace {

constexpr double kCornerTimesHalfSupport = 0.477;

bool nodes_ascend(const std::array<double, kCurveSegments>& nodes) noexcept {
  double last = 0.0;
  for (const double node : nodes) {
    if (!(node > last) || !std::isfinite(node)) return false;
    last = node;
  }
  return true;
}

bool fits(double corner_hz, double sample_rate_hz) noexcept {
  if (!(sample_rate_hz > 0.0) || !(corner_hz > 0.0)) return false;
  const int half = half_support_samples(corner_hz, sample_rate_hz);
  return half >= kMinHalfSupport && half <= kMaxHalfSupport;
}

}  // namespace

int half_support_samples(double corner_hz, double sample_rate_hz) noexcept {
  const double samples = kCornerTimesHalfSupport * sample_rate_hz / corner_hz;
  return static_cast<int>(std::lround(std::clamp(samples, 0.0, 1e6))) - 1 +
         TestFunction::kDifference;
}

Result<Config> check(const Config& config) noexcept {
  if (!fits(config.corner_hz, config.sample_rate_hz)) return Errc::kInvalidConfig;
  if (!fits(config.prediction_corner_hz, config.sample_rate_hz)) return Errc::kInvalidConfig;
  if (config.velocity_half_width < 1 || config.velocity_half_width > kMaxVelocityHalfWidth)
    return Errc::kInvalidConfig;
  if (!(config.sign_width_mps > 0.0) || !(config.still_mps >= 0.0)) return Errc::kInvalidConfig;
  if (config.block_samples < 1 || !nodes_ascend(config.curve_nodes_mps))
    return Errc::kInvalidConfig;
  return config;
}

Result<Terms> check(const Terms& terms) noexcept {
  if (terms.offset && terms.coulomb == Branches::kSeparate) return Errc::kInvalidConfig;
  return terms;
}

}  // namespace dampline::rig
