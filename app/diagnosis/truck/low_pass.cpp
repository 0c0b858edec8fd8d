// SPDX-License-Identifier: MIT
#include "app/diagnosis/truck/low_pass.hpp"

#include <algorithm>
#include <optional>

#include "app/diagnosis/truck/verdict.hpp"
#include "app/identify/low_pass.hpp"
#include "app/identify/truck_run.hpp"

namespace dampline::app {
namespace {

constexpr double kMuchLower = 0.65;  // times the declared: friction seems to build up, too
constexpr double kOfFaults = 0.6;    // of what is left otherwise, where the guards named faults

bool builds_up(const effect::Step& step) { return effect::has_memory(step.chosen.effect); }

/// The frame's corner by its lateness, if that is a lower one and its leaps tell of the same.
std::optional<OtherLowPass> other_of_frame(const Config& config, const FrameNoise& noise,
                                           const effect::Explanation& e) {
  const AntiAliasConfig declared = estimator_config(config).anti_alias.of(0);
  const std::optional<double> late_s = frame_late_s(e);
  if (!late_s || !(declared.corner_hz > 0.0)) return std::nullopt;
  const double by_delay_hz = declared.corner_hz / (1.0 + *late_s / delay_s(declared));
  const double most = any_of_steps(e, builds_up) ? kMuchLower : kLower;
  if (by_delay_hz > most * declared.corner_hz) return std::nullopt;
  const double seen_hz = noise.corner_hz();
  // Nearer to it than to the declared one.
  if (seen_hz == 0.0 || seen_hz * seen_hz > by_delay_hz * std::min(declared.corner_hz, kUsualHz))
    return std::nullopt;
  return OtherLowPass{FaultChannel::kFrame, by_delay_hz, e.final.held_out_nmse};
}

/// Of wheelsets of which one follows later, or has more of what is fast.
bool is_of_wheelset(const Fault& fault) {
  const bool one =
      fault.channel == FaultChannel::kWheelset1 || fault.channel == FaultChannel::kWheelset2;
  return fault.kind == FaultKind::kWrongSampleRate ||
         (fault.kind == FaultKind::kExcessNoise && one);
}

std::optional<OtherLowPass> low_pass_of(const Config& config, const SourceOptions& source,
                                        const FrameNoise& noise, const Explained& out) {
  const std::optional<double> as_declared = out.identified.fit.held_out_nmse;
  if (!as_declared || out.drifts || out.other) return std::nullopt;
  if (out.withheld) {
    const auto faults = out.circumstances.faults.list();
    if (!std::all_of(faults.begin(), faults.end(), is_of_wheelset)) return std::nullopt;
    return other_low_pass_of_wheelsets(config, source, *as_declared, kOfFaults * *as_declared);
  }
  const bool is_complete = conclusion_of(out) == effect::Conclusion::kComplete;
  const bool could_be_too_low = config.input.anti_alias.corner_hz < kUsualHz;
  if (is_complete && !could_be_too_low && left_over_floor(out) > kBelowFloor) return std::nullopt;
  const effect::Explanation& e = out.explanation;
  std::optional<double> by_effects;
  if (e.step_count > 0) by_effects = left_nmse(out);
  auto found = other_low_pass(config, source, *as_declared, by_effects);
  if (!any_of_steps(e, is_late)) return found;
  const auto of_wheelsets = other_low_pass_of_wheelsets(config, source, *as_declared, *by_effects);
  if (of_wheelsets && (!found || of_wheelsets->nmse < found->nmse)) found = of_wheelsets;
  return found ? found : other_of_frame(config, noise, e);
}

/// By how much the channels are late behind such a low pass.
LateEstimates lateness_behind(const OtherLowPass& found, const AntiAliasConfig& declared) {
  LateEstimates out{};
  const double behind_s = delay_s({.corner_hz = found.corner_hz, .order = declared.order});
  for (std::size_t c = 0; c < kChannels; ++c) {
    const bool is_one = found.channel == static_cast<FaultChannel>(c) ||
                        (found.channel == FaultChannel::kWheelsets && c > 0);
    if (is_one) out[c].value = behind_s - delay_s(declared.of(c));
  }
  return out;
}

}  // namespace

void look_for_low_pass(const Config& config, const SourceOptions& source, const FrameNoise& noise,
                       Explained& out) {
  const auto found = low_pass_of(config, source, noise, out);
  if (!found) return;
  if (found->channel != FaultChannel::kAll) {
    excuse_rate(config, lateness_behind(*found, estimator_config(config).anti_alias), out);
    excuse(out, [](const Fault& fault) { return fault.kind == FaultKind::kExcessNoise; });
  }
  name_and_withhold(FaultKind::kWrongLowPass, found->channel, found->corner_hz, out);
}

void look_for_frame_low_pass(const Config& config, const FrameNoise& noise, Explained& out) {
  const effect::Explanation& e = out.explanation;
  if (out.withheld || out.drifts || out.other || !any_of_steps(e, is_late)) return;
  const auto found = other_of_frame(config, noise, e);
  if (found) name_and_withhold(FaultKind::kWrongLowPass, found->channel, found->corner_hz, out);
}

}  // namespace dampline::app
