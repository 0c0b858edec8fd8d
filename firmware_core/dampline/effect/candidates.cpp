// SPDX-License-Identifier: MIT
#include "dampline/effect/candidates.hpp"

#include <algorithm>

namespace dampline::effect {
namespace {

void add_candidate(CandidateList& out, Effect effect, std::size_t variant, std::uint8_t form,
                   std::int8_t sign, const Regressor& regressor) noexcept {
  Candidate& c = out.item[out.count++];
  c = {.effect = effect,
       .variant = static_cast<std::uint8_t>(variant),
       .form = form,
       .sign = sign,
       .count = 1};
  c.regressor[0] = regressor;
}

/// Two neighbours of a grid side by side: what lies between them.
void add_pair(CandidateList& out, Effect effect, std::size_t variant, std::uint8_t form,
              std::int8_t sign, int column) noexcept {
  add_candidate(out, effect, variant, form, sign, Regressor::of(column));
  Candidate& c = out.item[out.count - 1];
  c.regressor[c.count++] = Regressor::of(column + 1);
}

void add_damping(CandidateList& out) noexcept {
  add_candidate(out, Effect::kViscous, 0, kPlainForm, 1, viscous_regressor());
  add_candidate(out, Effect::kQuadraticDamping, 0, kPlainForm, 1, Regressor::of(kSpeedSquared));
  add_candidate(out, Effect::kAsymmetricViscous, 0, kPlainForm, 0, Regressor::of(kSpeed));
  Candidate& both = out.item[out.count - 1];
  both.regressor[both.count++] = viscous_regressor();
}

void add_relaxations(const Grids& grids, CandidateList& out) noexcept {
  for (std::size_t i = 0; i < kRelaxations; ++i) {
    add_candidate(out, Effect::kViscoelastic, i, kPlainForm, 1, Regressor::of(kRelaxing + at(i)));
    if (i + 1 < kRelaxations && !grids.is_fine(Effect::kViscoelastic))
      add_pair(out, Effect::kViscoelastic, i, kPlainForm, 1, kRelaxing + at(i));
  }
}

void add_friction(const Grids& grids, CandidateList& out) noexcept {
  add_candidate(out, Effect::kProgressiveFriction, 0, kPlainForm, 0, Regressor::of(kProgressive));
  add_candidate(out, Effect::kProgressiveFriction, 0, kAbsoluteForm, 0,
                Regressor::of(kProgressiveAbsolute));
  for (std::size_t i = 0; i < kStribeckSpeeds; ++i) {
    if (grids.is_fine(Effect::kStribeck) && i != kFineStribeck) continue;
    add_candidate(out, Effect::kStribeck, i, kPlainForm, 1, Regressor::of(kStribeck + at(i)));
  }
  for (std::size_t i = 0; i < kDahlDistances; ++i) {
    add_candidate(out, Effect::kPreslidingHysteresis, i, kPlainForm, 1,
                  Regressor::of(kDahl + at(i)));
    if (i + 1 < kDahlDistances && !grids.is_fine(Effect::kPreslidingHysteresis)) {
      add_pair(out, Effect::kPreslidingHysteresis, i, kPlainForm, 1, kDahl + at(i));
    }
  }
  for (std::size_t i = 0; i < kBacklashGaps; ++i) {
    add_candidate(out, Effect::kBacklash, i, kPlainForm, 1, Regressor::of(kBacklash + at(i)));
    if (i + 1 < kBacklashGaps && !grids.is_fine(Effect::kBacklash)) {
      add_pair(out, Effect::kBacklash, i, kPlainForm, 1, kBacklash + at(i));
    }
  }
}

void add_stiffness(CandidateList& out) noexcept {
  add_candidate(out, Effect::kCubicStiffness, 0, kPlainForm, 0, Regressor::of(kCube));
  add_candidate(out, Effect::kQuadraticStiffness, 0, kPlainForm, 0, Regressor::of(kSquare));
  add_candidate(out, Effect::kAsymmetricStiffness, 0, kPlainForm, 0, Regressor::of(kMagnitude));
  for (std::size_t i = 0; i < kBumpGaps; ++i) {
    const Regressor up = Regressor::of(kBumpUp + at(i));
    add_candidate(out, Effect::kBumpStop, i, kPlainForm, 1, up.plus(kBumpDown + at(i), -1.0));
    add_candidate(out, Effect::kBumpStop, i, kOneSidedUp, 1, up);
    add_candidate(out, Effect::kBumpStop, i, kOneSidedDown, 1,
                  Regressor::of(kBumpDown + at(i), -1.0));
  }
}

void add_modes(const Grids& grids, CandidateList& out) noexcept {
  for (std::size_t i = 0; i < kPitchModes; ++i) {
    add_candidate(out, Effect::kUnmodelledMode, i, kPitchForm, 1,
                  Regressor::of(kPitchSign + at(i)));
  }
  for (std::size_t i = 0; i < kFlexibleModes; ++i) {
    add_candidate(out, Effect::kUnmodelledMode, i, kFlexibleForm, -1,
                  Regressor::of(kModeBend + at(i)));
    if (i + 1 < kFlexibleModes && !grids.is_fine(Effect::kUnmodelledMode)) {
      add_pair(out, Effect::kUnmodelledMode, i, kFlexibleForm, -1, kModeBend + at(i));
    }
  }
}

/// With x_true(t) = x(t + tau), or x_true = x (1 - e), to first order:
///   frame:    -a = k y + F(v) + tau (a' + 2 k z_b') + ...
///   wheelset: -a = k y + F(v) - tau (k z_i' + F'(v) z_i'')
/// A gain of the frame's sensor stretches k and F too, so only what it does to y and v is a column;
/// gains have the tangent of the friction law, since signs change where |v| is small.
Regressor skew_regressor(const BaseForce& base, std::uint8_t form) noexcept {
  if (form == kFrameForm) return Regressor::of(kFrameRate).plus(kFrameOnce, 2.0 * base.stiffness);
  const bool first = form == kWheelset1Form;
  return Regressor::of(first ? kWheelset1Once : kWheelset2Once, -base.stiffness)
      .plus(first ? kTangentRate1 : kTangentRate2, -base.coulomb);
}
Regressor gain_regressor(const BaseForce& base, std::uint8_t form) noexcept {
  if (form == kFrameForm) {
    return Regressor::of(kFrameTwice, -2.0 * base.stiffness)
        .plus(kTangentV, -base.coulomb)
        .plus(kTangent1, -base.coulomb)
        .plus(kTangent2, -base.coulomb);
  }
  const bool first = form == kWheelset1Form;
  return Regressor::of(first ? kWheelset1Twice : kWheelset2Twice, base.stiffness)
      .plus(first ? kTangent1 : kTangent2, base.coulomb);
}
void add_sensors(const BaseForce& base, CandidateList& out) noexcept {
  for (const std::uint8_t form : {kFrameForm, kWheelset1Form, kWheelset2Form}) {
    add_candidate(out, Effect::kTimeSkew, 0, form, 0, skew_regressor(base, form));
    add_candidate(out, Effect::kGainError, 0, form, 0, gain_regressor(base, form));
  }
}

}  // namespace

const char* name_of(Effect effect) noexcept {
  constexpr std::array<const char*, kEffects> kNames{"viscous",
                                                     "asymmetric_viscous",
                                                     "quadratic_damping",
                                                     "viscoelastic",
                                                     "progressive_friction",
                                                     "stribeck",
                                                     "presliding_hysteresis",
                                                     "backlash",
                                                     "bump_stop",
                                                     "cubic_stiffness",
                                                     "quadratic_stiffness",
                                                     "asymmetric_stiffness",
                                                     "unmodelled_mode",
                                                     "time_skew",
                                                     "gain_error",
                                                     "impulsive_input",
                                                     "unknown"};
  return kNames[static_cast<std::size_t>(effect)];
}

Regressor stiffness_regressor() noexcept {
  return Regressor::of(kFrameTwice, 2.0).plus(kWheelset1Twice, -1.0).plus(kWheelset2Twice, -1.0);
}
Regressor viscous_regressor() noexcept {
  return Regressor::of(kFrameOnce, 2.0).plus(kWheelset1Once, -1.0).plus(kWheelset2Once, -1.0);
}

void refresh(const BaseForce& base, Candidate& candidate) noexcept {
  if (candidate.effect == Effect::kTimeSkew)
    candidate.regressor[0] = skew_regressor(base, candidate.form);
  if (candidate.effect == Effect::kGainError)
    candidate.regressor[0] = gain_regressor(base, candidate.form);
}

namespace {

Regressor point_of(const Candidate& c, std::size_t i) noexcept {
  switch (c.effect) {
    case Effect::kViscoelastic:
      return Regressor::of(kRelaxing + at(i));
    case Effect::kStribeck:
      return Regressor::of(kStribeck + at(i));
    case Effect::kPreslidingHysteresis:
      return Regressor::of(kDahl + at(i));
    case Effect::kBacklash:
      return Regressor::of(kBacklash + at(i));
    case Effect::kBumpStop:
      if (c.form == kOneSidedDown) return Regressor::of(kBumpDown + at(i), -1.0);
      return c.form == kOneSidedUp ? Regressor::of(kBumpUp + at(i))
                                   : Regressor::of(kBumpUp + at(i)).plus(kBumpDown + at(i), -1.0);
    default:
      return Regressor::of((c.form == kPitchForm ? kPitchSign : kModeBend) + at(i));
  }
}

/// Of the points of an effect's grid.
std::size_t points_of(const Candidate& c, const Grids& grids) noexcept {
  switch (c.effect) {
    case Effect::kViscoelastic:
      return kRelaxations;
    case Effect::kStribeck:
      return kStribeckSpeeds;
    case Effect::kPreslidingHysteresis:
      return kDahlDistances;
    case Effect::kBacklash:
      return kBacklashGaps;
    case Effect::kBumpStop:
      return kBumpGaps;
    case Effect::kUnmodelledMode:
      if (c.form == kPitchForm) return kPitchModes;
      return grids.is_fine(c.effect) ? kFineFrequencies * kFineDampings : kFlexibleModes;
    default:
      return 0;
  }
}

/// Between the points on either side of the candidate's own, as far as they lie in first...end - 1.
void add_slope(Candidate& c, std::size_t apart, std::size_t first, std::size_t end) noexcept {
  const std::size_t i = c.variant;
  const std::size_t low = i >= first + apart ? i - apart : i;
  const std::size_t high = i + apart < end ? i + apart : i;
  if (low == high) return;
  const double weight = static_cast<double>(apart) / static_cast<double>(high - low);
  const Regressor above = point_of(c, high);
  const Regressor below = point_of(c, low);
  Regressor slope;
  for (std::size_t k = 0; k < above.count; ++k)
    slope = slope.plus(above.column[k], weight * above.weight[k]);
  for (std::size_t k = 0; k < below.count; ++k)
    slope = slope.plus(below.column[k], -weight * below.weight[k]);
  c.regressor[c.count++] = slope;
  ++c.slopes;
}

}  // namespace

Candidate with_slopes(const Candidate& candidate, const Grids& grids) noexcept {
  Candidate out = candidate;
  const std::size_t points = points_of(candidate, grids);
  if (points == 0 || candidate.count != 1) return out;
  const std::size_t line =
      std::min(line_of(candidate.effect, candidate.form == kPitchForm, grids), points);
  const std::size_t first = candidate.variant / line * line;
  add_slope(out, 1, first, first + line);
  if (line < points) add_slope(out, line, 0, points);
  return out;
}

void list_candidates(const BaseForce& base, const Grids& grids, CandidateList& out) noexcept {
  out.count = 0;
  add_damping(out);
  add_relaxations(grids, out);
  add_friction(grids, out);
  add_stiffness(out);
  add_modes(grids, out);
  add_sensors(base, out);
}

}  // namespace dampline::effect
