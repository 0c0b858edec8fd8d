// SPDX-License-Identifier: MIT
#include "app/run/trust.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "app/text/format.hpp"

namespace dampline::app {
namespace {

constexpr std::array<const char*, 4> kNames{"trusted", "model_incomplete", "data_faulty",
                                            "not_identified"};

// What a complete model of a truck leaves is made at the reversals, where the velocity's error
// decides on the sign of friction: about the square of the share of time spent within the law's
// width, 0.8 to 1.8 times on clean records.
constexpr double kSmallMisfit = 0.005;
constexpr double kMisfitOfSticking = 3.0;
constexpr double kWidestLawMps = 6e-3;  // a wider one is no error of the velocity
constexpr double kStickMps = 2e-3;      // below it a truck counts as sticking
constexpr double kNothingFitted = 0.8;  // of the variance, left
constexpr double kSure = 3.0;           // deviations
constexpr double kFallsWithin = 0.5;    // of the rms velocity, of friction that falls
constexpr double kWidestShare = 0.7;    // of the rms velocity, of a law whose level is seen
constexpr double kFoldedShare = 0.25;   // of the rms velocity, of a law that folding widens
constexpr double kViscousShare = 0.03;  // of dry friction at the rms velocity
constexpr double kViscousSigmas = 5.0;
constexpr double kLeastFriction = 0.01;  // of the weight
constexpr double kLeastFollow = 0.4;     // of the wheelsets' motion: in g it would be 0.11
constexpr double kMostFollow = 3.0;
// A frame's sensor off the middle: 0.05 m and more of 1.8 m. Sound records that leave as much show
// 0.063 at most, a share of 0.03.
constexpr double kPitch = 0.08;
constexpr double kPitchShare = 0.1;
constexpr double kPitchLeaves = 0.03;  // of the variance
// A frame that is late or early; it seems to be so by 0.17 ms at most in quiet sound records, by
// 0.6 ms where the sensors' noise is 0.1 m/s^2.
constexpr double kOutOfTimeS = 0.75e-3;

using Reasons = std::vector<std::pair<Trust, std::string>>;

std::string words(double value, double std, std::string_view unit) {
  const QuantityText text = format_quantity(value, std);
  return fmt::format("{}{}{}{}{}", text.value, text.std.empty() ? "" : " ± ", text.std,
                     unit.empty() ? "" : " ", unit);
}

bool is_truck(const RunResult& result) { return result.kind == "truck"; }

// Below the suspension's resonance the frame moves as the wheelsets do, whatever car it is.
void judge_units(const RunResult& result, const Magnitudes& seen, Reasons& out) {
  const double follows = seen.frame_follow;
  if (follows > 0.0 && (follows < kLeastFollow || follows > kMostFollow))
    out.emplace_back(
        Trust::kDataFaulty,
        fmt::format("The frame moves {:.2g} times as much as the wheelsets at 1.2 Hz, where it "
                    "follows them 1.05 to 1.3 times: are its accelerations in another unit{}?",
                    follows, follows < kLeastFollow ? ", in g" : ""));
  const Parameter* const coulomb = find_parameter(result.parameters, "coulomb");
  if (coulomb == nullptr || !(seen.wheelset_mps2 > 0.0)) return;
  const double share = coulomb->value / seen.weight_n;
  if (share < 0.0 || share > kLeastFriction || seen.wheelset_mps2 > kLeastShakingMps2) return;
  out.emplace_back(
      Trust::kDataFaulty,
      fmt::format("The wheelsets shake by {:.2g} m/s^2 rms and friction is {:.2g} % of the weight, "
                  "a tenth of what trucks have: are the accelerations in g? They are taken as "
                  "m/s^2; forces of accelerations in g come out 9.8 times too small.",
                  seen.wheelset_mps2, 100.0 * share));
}

void judge_data(const Explaining* explaining, const RunResult& result, Reasons& out) {
  const DataFaults& faults = result.faults;
  std::string names;
  for (const FaultFinding& f : faults.list)
    names += fmt::format("{}{} ({})", names.empty() ? "" : ", ", f.name, f.channel);
  if (faults.lasting || (explaining != nullptr && explaining->withheld))
    out.emplace_back(Trust::kDataFaulty, fmt::format("The data have faults: {}.", names));
  if (explaining != nullptr && explaining->frame_gain)
    out.emplace_back(
        Trust::kDataFaulty,
        fmt::format("By the frame's own motion its sensor tells {} too {}, which the effects that "
                    "were found hide: correct it, and explain anew.",
                    words(std::abs(100.0 * explaining->frame_gain->value),
                          100.0 * explaining->frame_gain->std, "%"),
                    explaining->frame_gain->value < 0.0 ? "little" : "much"));
  if (result.magnitudes) judge_units(result, *result.magnitudes, out);
}

struct Positive {
  const char* name;
  const char* reason;  ///< where it is less than nothing
};
constexpr std::array kPositive{Positive{"coulomb", "Dry friction comes out negative"},
                               Positive{"coulomb_positive", "Dry friction comes out negative"},
                               Positive{"coulomb_negative", "Dry friction comes out negative"},
                               Positive{"stiffness", "The spring comes out negative"},
                               Positive{"moving_mass", "The mass comes out negative"}};

std::string what_to_check(const RunResult& result) {
  return is_truck(result) ? ": are channels exchanged, or in another unit or direction?"
                          : ": is the force of the other sign?";
}

void judge_numbers(const RunResult& result, Reasons& out) {
  for (const Positive& p : kPositive) {
    const Parameter* const found = find_parameter(result.parameters, p.name);
    if (found == nullptr) continue;
    // A rig's spring or mass that may be none is a finding; a truck has both.
    const bool negative = is_truck(result)
                              ? !(found->value > 0.0)
                              : found->value < -kSure * found->std || !std::isfinite(found->value);
    if (negative) {
      out.emplace_back(Trust::kNotIdentified, p.reason + what_to_check(result));
      return;
    }
    if (is_truck(result) && !(found->value > kSure * found->std)) {
      out.emplace_back(Trust::kNotIdentified,
                       fmt::format("The {} cannot be told from nothing: it is smaller than three "
                                   "times its deviation.",
                                   p.name));
      return;
    }
  }
}

/// Friction that falls over more speed than the motion has does not show to which level.
void judge_fall(const RunResult& result, Reasons& out) {
  const Parameter* const speed = find_parameter(result.parameters, "stribeck_speed");
  if (speed == nullptr || !result.fit.velocity_rms_mps) return;
  const double share = speed->value / *result.fit.velocity_rms_mps;
  if (share <= kFallsWithin) return;
  out.emplace_back(
      Trust::kModelIncomplete,
      fmt::format("Friction falls over {:.2g} times the rms velocity: the motion hardly shows to "
                  "which level.",
                  share));
}

void judge_width(const RunResult& result, Reasons& out) {
  const std::optional<double> share = result.fit.law_width_share;
  if (!share) return;
  if (result.magnitudes && result.magnitudes->is_unfiltered && *share > kFoldedShare)
    out.emplace_back(
        Trust::kModelIncomplete,
        fmt::format("The law is {:.2g} times as wide as the rms velocity, and no low pass is "
                    "declared (corner_hz = 0): without one, what is faster than half the sample "
                    "rate is folded into the motion, and the level comes out some percent too "
                    "high.",
                    *share));
  if (*share <= kWidestShare) return;
  out.emplace_back(
      Trust::kModelIncomplete,
      fmt::format("The law is {:.2g} times as wide as the rms velocity: the motion hardly leaves "
                  "its width, and does not show the level of dry friction.",
                  *share));
}

std::optional<double> left_of(const Fit& fit) {
  return fit.held_out_nmse ? fit.held_out_nmse : fit.nmse;
}

/// What a complete model may leave where nobody has worked it out.
double most_left(const RunResult& result) {
  if (!is_truck(result)) return kRigMisfit;
  const double width_mps = std::min(result.fit.law_width_mps.value_or(kStickMps), kWidestLawMps);
  const double within = result.stick_share.value_or(0.0) * width_mps / kStickMps;
  return std::max(kSmallMisfit, kMisfitOfSticking * within * within);
}

void judge_place(const RunResult& result, double left, Reasons& out) {
  if (!result.magnitudes) return;
  const Magnitudes& seen = *result.magnitudes;
  if (seen.pitch < kPitch || seen.pitch_share < kPitchShare || left < kPitchLeaves) return;
  out.emplace_back(
      Trust::kModelIncomplete,
      fmt::format("The frame shows {:.0f} % of half the wheelsets' difference, which it does where "
                  "it pitches: its sensor does not sit over the middle.",
                  100.0 * seen.pitch));
}

void judge_time(const RunResult& result, Reasons& out) {
  if (std::abs(result.frame_late_s.value_or(0.0)) < kOutOfTimeS) return;
  out.emplace_back(
      Trust::kModelIncomplete,
      fmt::format(
          "The frame seems {:.1f} ms {} than the wheelsets: `dampline explain` tells whether "
          "it is, is behind another low pass, or moves by another law.",
          1e3 * std::abs(*result.frame_late_s), *result.frame_late_s > 0.0 ? "later" : "earlier"));
}

void judge_fit(const Explaining* explaining, const RunResult& result, Reasons& out) {
  const std::optional<double> left = left_of(result.fit);
  if (!left || !std::isfinite(*left)) return;
  if (!(*left < kNothingFitted)) {
    out.emplace_back(Trust::kNotIdentified,
                     fmt::format("The model explains next to nothing: {:.0f} % of the variance is "
                                 "left.",
                                 100.0 * *left));
    return;
  }
  judge_place(result, *left, out);
  if (explaining != nullptr && explaining->incomplete) {
    out.emplace_back(Trust::kModelIncomplete,
                     fmt::format("Something is left that the model does not explain: {:.2g} % of "
                                 "the variance, more than sensors and rounding make.",
                                 100.0 * *left));
    return;
  }
  if (explaining != nullptr && explaining->judged) return;
  const double most = most_left(result);
  if (*left <= most) return;
  out.emplace_back(
      Trust::kModelIncomplete,
      fmt::format("The model does not fit: it leaves {:.2g} % of the variance, a complete one at "
                  "most {:.2g} %.{}",
                  100.0 * *left, 100.0 * most,
                  explaining == nullptr ? " `dampline explain` finds out what it lacks." : ""));
}

void judge_terms(const Explaining* explaining, const RunResult& result, Reasons& out) {
  if (!result.lacking.empty())
    out.emplace_back(Trust::kModelIncomplete,
                     fmt::format("The model lacks {}: the law with it stands in the explanation.",
                                 fmt::join(result.lacking, ", ")));
  else if (result.faults.drift)
    out.emplace_back(
        Trust::kModelIncomplete,
        fmt::format("A parameter is not constant: {} changed by {:+.1f} %.{}",
                    result.faults.drift->parameter, result.faults.drift->change_percent.value,
                    explaining == nullptr ? " `dampline explain` tells when." : ""));
}

void judge_speed(const Explaining* explaining, const RunResult& result, Reasons& out) {
  const std::optional<ViscousPart>& v = result.fit.viscous;
  if (!v || std::abs(v->share) <= kViscousShare || std::abs(v->sigmas) <= kViscousSigmas) return;
  out.emplace_back(
      Trust::kModelIncomplete,
      fmt::format(
          "The model lacks something that depends on speed, {:.0f} % of the dry friction{}.",
          100.0 * std::abs(v->share),
          explaining == nullptr ? ": `dampline explain` finds out what"
                                : ", and no effect of the library is it"));
}

std::string truck_numbers(const RunResult& result) {
  const Parameter* const coulomb = find_parameter(result.parameters, "coulomb");
  const Parameter* const stiffness = find_parameter(result.parameters, "stiffness");
  if (coulomb == nullptr || stiffness == nullptr) return "";
  return fmt::format(
      "Dry friction (Coulomb level) of {} and a spring of {}, identified from {} of record.",
      words(coulomb->value, coulomb->std, "N"),
      words(1e-6 * stiffness->value, 1e-6 * stiffness->std, "MN/m"),
      format_duration(result.duration_s));
}

std::string rig_numbers(const RunResult& result) {
  std::string text;
  for (const Parameter& p : result.parameters)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", p.name, words(p.value, p.std, p.unit));
  return fmt::format("{}: the model fits. Rrse {:.3f}, from {} of record.", text,
                     result.fit.rrse.value_or(0.0), format_duration(result.duration_s));
}

constexpr std::array<const char*, 4> kLeads{
    "", "The model does not fit this record, so no number is stated here. ",
    "The data are faulty, so no number is stated here. ",
    "Nothing could be identified that can be stated here. "};

}  // namespace

const char* name_of(Trust trust) noexcept { return kNames[static_cast<std::size_t>(trust)]; }

Trust trust_of(const std::string& name) noexcept {
  const auto* const found = std::find(kNames.begin(), kNames.end(), name);
  return found == kNames.end() ? Trust::kNotIdentified : static_cast<Trust>(found - kNames.begin());
}

void judge_trust(const Explaining* explaining, RunResult& result) {
  Reasons reasons;
  judge_data(explaining, result, reasons);
  judge_numbers(result, reasons);
  judge_width(result, reasons);
  judge_fall(result, reasons);
  judge_fit(explaining, result, reasons);
  judge_time(result, reasons);
  if (explaining == nullptr || explaining->unsteady) judge_terms(explaining, result, reasons);
  judge_speed(explaining, result, reasons);
  result.trust = Trust::kTrusted;
  result.trust_reasons.clear();
  result.headline = is_truck(result) ? truck_numbers(result) : rig_numbers(result);
  std::stable_sort(reasons.begin(), reasons.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  // What a wrong record leaves says nothing of the model.
  if (!reasons.empty() && reasons.front().first > Trust::kModelIncomplete)
    std::erase_if(reasons, [](const auto& r) { return r.first == Trust::kModelIncomplete; });
  for (auto& [trust, reason] : reasons) result.trust_reasons.push_back(std::move(reason));
  result.std_is_lower_bound = result.std_is_unproven || !reasons.empty();
  if (reasons.empty()) return;
  result.trust = reasons.front().first;
  result.headline = kLeads[static_cast<std::size_t>(result.trust)] + result.trust_reasons.front();
}

}  // namespace dampline::app
