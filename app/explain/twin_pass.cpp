// SPDX-License-Identifier: MIT
#include "app/explain/twin_pass.hpp"

#include <algorithm>
#include <cmath>

namespace dampline::app {
namespace {

constexpr double kOneKind = 3.0;      // of powers of noise
constexpr double kNoiseDoubt = 1.25;  // of the guards' median, which bursts do not lift

/// What the wheelsets do not share counts as their noise, and aliasing adds to it. Where sensors
/// may be of one kind, the frame's noise, which is measured apart from its motion, is that of all.
std::array<double, kChannels> noise_of(std::array<double, kChannels> seen_mps2,
                                       const std::array<double, kChannels>& step_mps2) {
  const auto rounding = [&](std::size_t c) { return step_mps2[c] * step_mps2[c] / 12.0; };
  const double frame = seen_mps2[0] * seen_mps2[0] - rounding(0);
  for (std::size_t c = 1; c < kChannels; ++c) {
    const double own = seen_mps2[c] * seen_mps2[c] - rounding(c);
    if (frame > 0.0 && own > frame && own < kOneKind * frame)
      seen_mps2[c] = std::sqrt(frame + rounding(c));
  }
  return seen_mps2;
}

}  // namespace

std::array<double, kChannels> noise_of_record(const TruckPass& first, const FrameNoise& frame,
                                              const std::array<double, kChannels>& step_mps2) {
  std::array<double, kChannels> seen{};
  for (std::size_t c = 0; c < kChannels; ++c) seen[c] = first.run->core().guard().noise_mps2(c);
  const double whole = frame.noise_mps2();
  if (seen[0] > 0.0 && whole > 0.0)
    seen[0] = std::clamp(whole, seen[0] / kNoiseDoubt, kNoiseDoubt * seen[0]);
  return noise_of(seen, step_mps2);
}

TwinConfig twin_config(const EstimatorConfig& core, const effect::Explanation& e,
                       const std::array<double, kChannels>& noise_mps2) {
  TwinConfig out;
  out.sample_rate_hz = core.sample_rate_hz;
  out.stiffness_per_s2 = e.final.theta[effect::ModelFit::kStiffness];
  const double mass_kg = e.final_stiffness_npm.value / out.stiffness_per_s2;
  out.coulomb_mps2 = e.final_coulomb_n.value / mass_kg;
  if (e.base_count > 0) out.viscous_per_s = e.final.theta[effect::ModelFit::kFirstEffect];
  out.anti_alias_hz = core.anti_alias.corner_hz;
  out.noise_mps2 = noise_mps2;
  out.step_mps2 = core.screen.step_mps2;
  return out;
}

TwinConfig with_memory(TwinConfig out, const effect::Explanation& e) {
  const double mass_kg = e.final_coulomb_n.value / out.coulomb_mps2;
  for (std::size_t i = 0; i < e.step_count; ++i) {
    if (!effect::has_memory(e.step[i].chosen.effect)) continue;
    const auto& parameter = e.step[i].parameter;  // force and length
    out.memory = {e.step[i].chosen.effect == effect::Effect::kBacklash,
                  parameter[0].estimate.value / mass_kg, parameter[1].estimate.value};
    out.coulomb_mps2 = std::max(out.coulomb_mps2 - out.memory.force_mps2, 0.0);
    return out;
  }
  return out;
}

bool is_physical(const TwinConfig& c) {
  return c.stiffness_per_s2 > 0.0 && c.coulomb_mps2 > 0.0 && c.viscous_per_s >= 0.0;
}

}  // namespace dampline::app
