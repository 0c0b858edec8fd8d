// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <cstddef>

#include "published/phase/scaling_verdict.hpp"
#include "published/phase/section_means.hpp"

namespace dampline {

/// Test whether the steady response grows in proportion to its input: of two runs at the same
/// frequency, the deflection, velocity and acceleration at each phase, less their means over the
/// phases, must have the ratio that the inputs have. Not for the sample path.
template <int Phases>
[[nodiscard]] ScalingVerdict judge_scaling(const SectionMeans<Phases>& small,
                                           const SectionMeans<Phases>& large) noexcept {
  static_assert(Phases >= 4);
  using At = typename SectionMeans<Phases>::AtPhase;
  const auto pick = [&](RunningMean At::*channel) {
    ChannelPair<Phases> pair;
    for (std::size_t i = 0; i < pair.small.size(); ++i) {
      pair.small[i] = small.phases[i].*channel;
      pair.large[i] = large.phases[i].*channel;
    }
    return pair;
  };
  const ChannelPair<Phases> input = pick(&At::input);
  if (!input.enough()) return {};
  ScalingVerdict out = judge_input(input.swings());
  if (out.state != ScalingState::kProportional) return out;
  ScalingSums sums;
  for (RunningMean At::*channel : {&At::deflection_m, &At::velocity_mps, &At::accel_mps2})
    sums.add(pick(channel).departure(out.input_ratio));
  return judge_departure(out, sums);
}

}  // namespace dampline
