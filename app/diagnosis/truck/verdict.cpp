// SPDX-License-Identifier: MIT
#include "app/diagnosis/truck/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dampline::app {

namespace {

constexpr double kFaintGain = 0.025;
constexpr double kClearlyAbove = 1.2;   // the floor: then what effects take of the excess is known
constexpr double kShareOfExcess = 0.1;  // over the floor, that effects must take
// Sensors out of place; effects leave at most 0.05, or 2.8 times the floor (P1 of constants.md).
constexpr double kMuchLeft = 0.1;
constexpr double kFarOverFloor = 2.0;
constexpr double kFarthestOverFloor = 3.0;
constexpr double kWideMps = 5e-3;        // of the base's law: so wrong is the velocity
constexpr double kForeign = 0.03;        // of the frame's power at 1.2 Hz
constexpr double kOffCentre = 0.12;      // of half the difference: 0.05 m off, wheelbase 1.8 m
constexpr double kOffCentreShare = 0.3;  // of what the mean leaves; sound records reach 0.27
constexpr double kLittleOff = 0.03;
constexpr double kLateAlike = 0.7;      // of both wheelsets' lateness
constexpr double kRateExcused = 0.003;  // of the delay, as the guard asks for
constexpr double kNoGain = 0.5;         // of a gain that is named: the powers show less of it

/// What is already less than sensors and rounding leave has no room for one effect more; for the
/// first, which may be large beside a floor that is too high, only where it gains little.
bool is_below_floor(const effect::Step& step, bool first, double floor_nmse) {
  if (first && step.gain > kFaintGain) return false;
  return step.held_out_nmse_before < kBelowFloor * floor_nmse;
}

/// A stop that pulls, friction with a memory that drives.
bool is_below_nothing(const effect::Step& step) {
  using effect::Effect;
  const Effect e = step.chosen.effect;
  const bool is_force =
      e == Effect::kBumpStop || e == Effect::kViscoelastic || effect::has_memory(e);
  return is_force && step.parameter[0].estimate.value < 0.0;
}

bool has(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// A gain of one wheelset that their powers do not show.
bool is_no_gain(const effect::Explanation& e, double gain) {
  for (const effect::Step& step : e.steps()) {
    if (step.chosen.effect != effect::Effect::kGainError) continue;
    const auto& named = step.parameter[0];
    const std::string_view name = named.name;
    const double sign = name == "gain_error_wheelset1" ? 1.0 : -1.0;
    const double shown = sign * gain / named.estimate.value;
    if (name != "gain_error_frame" && shown < kNoGain) return true;
  }
  return false;
}

std::optional<FaultKind> misplaced(const Explained& explained) {
  const Misplacement& seen = explained.circumstances.faults.misplacement;
  const effect::Explanation& e = explained.explanation;
  const bool much_left = e.final.held_out_nmse > kMuchLeft;
  const double ratio = left_over_floor(explained);
  const bool off = seen.difference > kOffCentre && seen.difference_share > kOffCentreShare;
  if (off && much_left && ratio > kFarOverFloor) return FaultKind::kOffCentre;
  if (seen.difference > kLittleOff && is_no_gain(e, seen.gain)) return FaultKind::kOffCentre;
  const bool foreign = seen.foreign_share > kForeign || e.base.width_mps > kWideMps;
  if (foreign && much_left && ratio > kFarthestOverFloor) return FaultKind::kForeignMotion;
  return std::nullopt;
}

void name_misplaced(Explained& out) noexcept {
  const auto kind = misplaced(out);
  if (!kind) return;
  const bool off = *kind == FaultKind::kOffCentre;
  const double share = off ? out.circumstances.faults.misplacement.difference : left_nmse(out);
  name_and_withhold(*kind, FaultChannel::kFrame, 100.0 * share, out);
}

/// Two wheelsets that are late alike are a frame that is early: one channel, and where that one
/// would not do, none.
bool are_late_alike(const LateEstimates& late_s) noexcept {
  const double ratio = late_s[effect::kWheelset1Form].value / late_s[effect::kWheelset2Form].value;
  return ratio > kLateAlike && ratio < 1.0 / kLateAlike;
}

bool are_faint(const effect::Explanation& e) noexcept {
  const double before = base_error(e);
  const double taken = before - e.final.held_out_nmse;
  return floor_ratio(e) > kClearlyAbove && taken < kShareOfExcess * (before - e.floor_nmse);
}

}  // namespace

bool is_late(const effect::Step& step) noexcept {
  return step.chosen.effect == effect::Effect::kTimeSkew;
}

bool any_of_steps(const effect::Explanation& e, bool (*is)(const effect::Step&)) noexcept {
  const auto steps = e.steps();
  return std::any_of(steps.begin(), steps.end(), is);
}

LateEstimates late_of(const effect::Explanation& e) noexcept {
  LateEstimates out{};
  for (const effect::Step& step : e.steps())
    if (is_late(step)) out[step.chosen.form] = step.parameter[0].estimate;
  return out;
}

std::optional<double> frame_late_s(const effect::Explanation& e) noexcept {
  const auto is_another = [](const effect::Step& step) {
    return !is_late(step) && !effect::has_memory(step.chosen.effect);
  };
  if (any_of_steps(e, is_another)) return std::nullopt;
  const LateEstimates late_s = late_of(e);
  const double first_s = late_s[effect::kWheelset1Form].value;
  const double second_s = late_s[effect::kWheelset2Form].value;
  if (first_s != second_s && !are_late_alike(late_s)) return std::nullopt;
  return late_s[effect::kFrameForm].value - 0.5 * (first_s + second_s);
}

void name_and_withhold(FaultKind kind, FaultChannel channel, double size, Explained& out) noexcept {
  FaultView& faults = out.circumstances.faults;
  if (faults.count == faults.faults.size()) return;
  faults.faults[faults.count++] = {
      .kind = kind, .channel = channel, .size = size, .unit = unit_of(kind), .count = 1};
  out.withheld = true;
  effect::withhold_effects(out.explanation);
}

void excuse(Explained& out, const std::function<bool(const Fault&)>& is_excused) {
  FaultView& faults = out.circumstances.faults;
  Fault* const begin = faults.faults.data();
  Fault* const end = begin + faults.count;
  for (const Fault& fault : faults.list()) {
    if (!is_excused(fault)) continue;
    std::erase_if(out.identified.faults.list, [&](const FaultFinding& found) {
      return found.name == name_of(fault.kind) && found.channel == name_of(fault.channel);
    });
  }
  faults.count = static_cast<std::size_t>(std::remove_if(begin, end, is_excused) - begin);
}

void excuse_rate(const Config& config, const LateEstimates& late_s, Explained& out) {
  if (!config.car.wheelbase_m || !config.input.speed_mps) return;
  const double between_s =
      late_s[effect::kWheelset2Form].value - late_s[effect::kWheelset1Form].value;
  const double late = std::abs(between_s) * *config.input.speed_mps / *config.car.wheelbase_m;
  excuse(out, [&](const Fault& fault) {
    const double off = std::abs(fault.size / config.input.sample_rate_hz - 1.0);
    return fault.kind == FaultKind::kWrongSampleRate && std::abs(off - late) < kRateExcused;
  });
}

void hold_back(Explained& out) noexcept {
  if (out.withheld || out.drifts) return;
  name_misplaced(out);
  if (are_faint(out.explanation)) effect::withhold_effects(out.explanation);
}

effect::ExplainerConfig explainer_config(const Config& config) {
  effect::ExplainerConfig out;
  out.moving_mass_kg = config.car.moving_mass_kg;
  out.base_viscous = has(config.model.base, "viscous");
  for (std::size_t i = 0; i < effect::kEffects; ++i) {
    const char* name = effect::name_of(static_cast<effect::Effect>(i));
    out.allowed[i] = is_wanted(config.model, name) && !has(config.model.base, name);
  }
  // What is left of a turn that is known looks like a late frame or a mode.
  if (config.car.frame_pitch_mass_kg) {
    out.allowed[static_cast<std::size_t>(effect::Effect::kTimeSkew)] = false;
    out.allowed[static_cast<std::size_t>(effect::Effect::kUnmodelledMode)] = false;
  }
  return out;
}

effect::ExplainerConfig explainer_config(const Config& config, const Explained& known) {
  effect::ExplainerConfig out = explainer_config(config);
  disallow_mimics(known.circumstances.faults, out);
  for (std::size_t i = 0; i < effect::kEffects; ++i)
    out.allowed[i] = out.allowed[i] && !known.needless.effect[i];
  out.two_late = !known.needless.second_late;
  return out;
}

bool judge_sums(const Config& config, const effect::Diagnosis& diagnosis,
                effect::Explainer& explainer, Explained& out) {
  effect::judge(diagnosis.sums(), explainer_config(config, out), out.circumstances, explainer, out);
  return out.explanation.conclusion != effect::Conclusion::kNotReady;
}

std::size_t needless_step(const effect::Explanation& e) noexcept {
  for (std::size_t i = 0; i < e.step_count; ++i) {
    const effect::Step& step = e.step[i];
    const Estimate& first = step.parameter[0].estimate;
    if (is_late(step) && std::abs(first.value) < 2.0 * first.std) return i;
    // Of friction that falls with speed, the part that falls.
    if (step.chosen.effect == effect::Effect::kStribeck && first.value < first.std) return i;
    if (is_below_nothing(step) || is_below_floor(step, i == 0, e.floor_nmse)) return i;
  }
  return e.step_count;
}

bool take_needless(const effect::Explanation& e, Needless& known) noexcept {
  if (are_late_alike(late_of(e))) {
    known.effect[static_cast<std::size_t>(effect::Effect::kTimeSkew)] = true;
    return true;
  }
  const std::size_t needless = needless_step(e);
  if (needless == e.step_count) return false;
  const effect::Step& step = e.step[needless];
  if (is_late(step) && std::any_of(e.step.data(), &step, is_late))
    known.second_late = true;
  else
    known.effect[static_cast<std::size_t>(step.chosen.effect)] = true;
  return true;
}

double left_nmse(const Explained& explained) noexcept {
  const effect::Explanation& e = explained.explanation;
  if (!explained.drifts) return e.final.held_out_nmse;
  return e.base.held_out_nmse * (1.0 - explained.identified.faults.drift->gain);
}

double left_over_floor(const Explained& explained) noexcept {
  const effect::Explanation& e = explained.explanation;
  if (!explained.drifts) return floor_ratio(e);
  return e.floor_nmse > 0.0 ? left_nmse(explained) / e.floor_nmse : 0.0;
}

effect::Conclusion conclusion_of(const Explained& explained) noexcept {
  const effect::Conclusion conclusion = explained.explanation.conclusion;
  if (explained.other && conclusion == effect::Conclusion::kComplete)
    return effect::Conclusion::kExplained;
  if (explained.other && conclusion == effect::Conclusion::kUnexplained)
    return effect::Conclusion::kPartlyExplained;
  if (!explained.drifts) return conclusion;
  const double ratio = left_over_floor(explained);
  return ratio > 0.0 && ratio < effect::kIncompleteAbove ? effect::Conclusion::kExplained
                                                         : effect::Conclusion::kPartlyExplained;
}

}  // namespace dampline::app
