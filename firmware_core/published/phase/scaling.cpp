// SPDX-License-Identifier: MIT
#include "published/phase/scaling.hpp"

#include <algorithm>
#include <cmath>

namespace dampline {
namespace {

constexpr double kLeastContrast = 0.1;  // relative difference of the inputs
constexpr double kShapeTolerance =
    0.05;                            // part of the larger input that is not the smaller's shape
constexpr double kRounding = 1e-12;  // relative, of a mean over many periods

}  // namespace

void ScalingSums::add(const Departure& d) noexcept {
  if (!(d.response > 0.0)) return;
  const double noise = d.noise + kRounding * kRounding * d.response;
  chi2 += d.squares / noise * d.degrees;
  share2 += d.squares / d.response;
  noise2 += noise / d.response;
  degrees += d.degrees;
  ++channels;
}

ScalingVerdict judge_input(const Swings& input) noexcept {
  ScalingVerdict out{.state = ScalingState::kNoInput};
  if (!(input.small2 > 0.0) || !(input.large2 > 0.0)) return out;
  out.input_ratio = input.both / input.small2;
  const double other_shape = input.large2 - input.both * out.input_ratio;
  if (other_shape > kShapeTolerance * kShapeTolerance * input.large2)
    out.state = ScalingState::kOtherShape;
  else if (std::abs(out.input_ratio - 1.0) < kLeastContrast)
    out.state = ScalingState::kSameInput;
  else
    out.state = ScalingState::kProportional;
  return out;
}

ScalingVerdict judge_departure(ScalingVerdict out, const ScalingSums& sums) noexcept {
  out.degrees = sums.degrees;
  if (sums.channels == 0) {
    out.state = ScalingState::kNoMotion;
    return out;
  }
  out.chi2 = sums.chi2 / sums.degrees;
  out.departure = std::sqrt(std::max(sums.share2, 0.0) / sums.channels);
  out.departure_std = std::sqrt(sums.noise2 / sums.degrees);
  if (out.chi2 > kScalingThreshold && out.departure > kScalingLeastDeparture)
    out.state = ScalingState::kDisproportional;
  return out;
}

}  // namespace dampline
