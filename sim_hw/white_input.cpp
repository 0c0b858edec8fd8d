// SPDX-License-Identifier: MIT
#include "sim_hw/white_input.hpp"

#include <cmath>
#include <numbers>

namespace dampline::sim {
namespace {

constexpr double kNoiseStepS = 1.0 / WhiteInput::kStepRateHz;
constexpr int kStepsPerSample = WhiteInput::kStepRateHz / 300;
constexpr double kAntiAliasHz = 100.0;

}  // namespace

WhiteInput::WhiteInput(const WhiteInputConfig& config)
    : beta_{2.0 * config.stiffness_npm / config.moving_mass_kg},
      alpha_positive_mps2_{2.0 * config.friction_positive_n / config.moving_mass_kg},
      alpha_negative_mps2_{2.0 * config.friction_negative_n / config.moving_mass_kg},
      viscous_ps_{2.0 * config.viscous_nspm / config.moving_mass_kg},
      noise_mps2_{std::sqrt(config.input_level / kNoiseStepS)},
      random_{config.seed, Stream::kTrack},
      anti_alias_{kAntiAliasHz, WhiteInput::kStepRateHz} {
  const auto settle = static_cast<std::int64_t>(config.settle_s * kStepRateHz);
  for (std::int64_t i = 0; i < settle; ++i) step();
}

double WhiteInput::rubbed(double velocity_mps) const noexcept {
  const double up = 0.5 * kNoiseStepS * alpha_positive_mps2_;
  const double down = 0.5 * kNoiseStepS * alpha_negative_mps2_;
  if (velocity_mps > up) return velocity_mps - up;
  return velocity_mps < -down ? velocity_mps + down : 0.0;
}

/// In continuous time v = 0 has no probability; here half a step of friction ends there from
/// -dt alpha_- / 2 to dt alpha_+ / 2, half a percent of the samples. Given as 0 they would all
/// count as v >= 0 and shift the force of both directions by 3 % of the level.
double WhiteInput::unresolved() const noexcept {
  return unresolved_mps_ - 0.25 * kNoiseStepS * (alpha_positive_mps2_ - alpha_negative_mps2_);
}

void WhiteInput::step() {
  deflection_m_ += 0.5 * kNoiseStepS * velocity_mps_;
  const double input_mps2 = noise_mps2_ * random_.normal();
  const double before_mps = rubbed(velocity_mps_);
  const double after_mps =
      before_mps + kNoiseStepS * (input_mps2 - beta_ * deflection_m_ - viscous_ps_ * before_mps);
  const double end_mps = rubbed(after_mps);
  alpha_mps2_ = 2.0 * (after_mps - end_mps) / kNoiseStepS + viscous_ps_ * end_mps;
  unresolved_mps_ = after_mps;
  velocity_mps_ = end_mps;
  deflection_m_ += 0.5 * kNoiseStepS * velocity_mps_;
  input_mps2_ = anti_alias_.update({input_mps2})[0];
}

Motion WhiteInput::next() {
  for (int i = 0; i < kStepsPerSample; ++i) step();
  const double frame_mps2 = -0.5 * (beta_ * deflection_m_ + alpha_mps2_);
  return {.tick = tick_++,
          .deflection_m = deflection_m_,
          .velocity_mps = velocity_mps_ != 0.0 ? velocity_mps_ : unresolved(),
          .frame_mps2 = frame_mps2,
          .relative_mps2 = 2.0 * frame_mps2 + input_mps2_};
}

double input_level_for(double velocity_rms_mps, double friction_n, double moving_mass_kg) noexcept {
  const double alpha_mps2 = 2.0 * friction_n / moving_mass_kg;
  return std::numbers::sqrt2 * alpha_mps2 * velocity_rms_mps;
}

}  // namespace dampline::sim
