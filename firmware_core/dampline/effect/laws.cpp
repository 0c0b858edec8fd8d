// SPDX-License-Identifier: MIT
#include "dampline/effect/laws.hpp"

#include <algorithm>
#include <cmath>

#include "dampline/basis/smooth_sign.hpp"

namespace dampline::effect {
namespace {

float single(double x) noexcept { return static_cast<float>(x); }

/// exp(-x) for x >= 0 by the inverse of its series: within 2 % to x = 1.5, positive beyond.
double decay(double x) noexcept {
  return 1.0 / (1.0 + x * (1.0 + x * (0.5 + x * (1.0 / 6.0 + x / 24.0))));
}

}  // namespace

Laws::Laws(const Grids& grids, double step_s) noexcept
    : grids_{grids}, pitch_{step_s, grids.pitch} {
  for (std::size_t i = 0; i < kRelaxations; ++i) {
    const double steps = step_s / grids.relaxation_s[i];
    kept_[i] = std::exp(-steps);
    taken_[i] = -std::expm1(-steps) / steps;
  }
}

void Laws::reset() noexcept {
  any_ = false;
  zeta_.fill(0.0);
  stretch_m_.fill(0.0);
  pitch_.reset();
}

void Laws::friction(const Point& p, LawValues& out) const noexcept {
  const double v = p.velocity_mps;
  const double speed = std::abs(v);
  for (std::size_t i = 0; i < kWidths; ++i) {
    out[kSign + at(i)] = single(smooth_sign(v, kWidthMps[i]));
  }
  const double sign = smooth_sign(v, kInnerWidthMps);
  const double x = kSignSlope * v / kInnerWidthMps;
  // d/dv erf(0.8862 v / w) = exp(-x^2) / w
  const double slope = x * x < 30.0 ? std::exp(-x * x) / kInnerWidthMps : 0.0;
  out[kTangent1] = single(slope * p.wheelset1_mps);
  out[kTangent2] = single(slope * p.wheelset2_mps);
  out[kTangentRate1] = single(slope * p.wheelset1_mps2);
  out[kTangentRate2] = single(slope * p.wheelset2_mps2);
  out[kTangentV] = single(slope * v);
  out[kProgressive] = single(p.deflection_m * sign);
  out[kProgressiveAbsolute] = single(std::abs(p.deflection_m) * sign);
  out[kSpeedSquared] = single(v * speed);
  out[kSpeed] = single(speed);
  double fading = std::exp(-speed / grids_.stribeck_mps[kStribeckSpeeds - 1]);
  for (std::size_t i = kStribeckSpeeds; i-- > 0; fading *= fading) {
    out[kStribeck + at(i)] = single(sign * fading);
  }
  for (std::size_t i = 0; i < kPitchModes; ++i) {
    out[kPitchSign + at(i)] = single(sign * (1.0 - pitch_.opposed(i)));
  }
}

void Laws::stiffness(double y, LawValues& out) const noexcept {
  out[kSquare] = single(y * y);
  out[kCube] = single(y * y * y);
  out[kMagnitude] = single(std::abs(y - grids_.kink * grids_.scale_m));
  for (std::size_t i = 0; i < kBumpGaps; ++i) {
    const double gap_m = grids_.bump_gap[i] * grids_.scale_m;
    out[kBumpUp + at(i)] = single(std::max(y - gap_m, 0.0));
    out[kBumpDown + at(i)] = single(std::max(-y - gap_m, 0.0));
  }
}

void Laws::memory(const Point& p, LawValues& out) noexcept {
  const double y = p.deflection_m;
  if (!any_) {
    any_ = true;
    last_deflection_m_ = y;
    piston_m_.fill(y);
  }
  const double step_m = y - last_deflection_m_;
  last_deflection_m_ = y;
  const double towards = step_m < 0.0 ? -1.0 : 1.0;
  for (std::size_t i = 0; i < kDahlDistances; ++i) {
    // d zeta / dy = (1 - zeta sign v) / r, exact over a way without reversal
    const double kept = decay(std::abs(step_m) / (grids_.dahl_distance[i] * grids_.scale_m));
    zeta_[i] = towards + (zeta_[i] - towards) * kept;
    out[kDahl + at(i)] = single(zeta_[i]);
  }
  double whole = 0.0;  // of an end's force, at this speed
  for (std::size_t i = 0; i < kBacklashGaps; ++i) {
    const PlayShape& play = grids_.play[i];
    if (i % kFineGaps == 0) whole = std::abs(smooth_sign(p.velocity_mps, play.width_mps));
    const double gap_m = play.gap * grids_.scale_m;
    piston_m_[i] = std::clamp(piston_m_[i], y - 0.5 * gap_m, y + 0.5 * gap_m);
    const double left_m = 0.5 * gap_m - towards * (y - piston_m_[i]);  // still to go to the end
    const double engaged = std::clamp(1.0 - left_m / (kEngagedOver * gap_m), 0.0, 1.0);
    out[kBacklash + at(i)] = single(engaged * towards * whole);
  }
  relax(step_m, out);
}

/// x' = v - x / tau, exact at an even speed: the force k x is that of a spring k behind a dashpot
/// k tau (Maxwell).
void Laws::relax(double step_m, LawValues& out) noexcept {
  for (std::size_t i = 0; i < kRelaxations; ++i) {
    stretch_m_[i] = kept_[i] * stretch_m_[i] + taken_[i] * step_m;
    out[kRelaxing + at(i)] = single(stretch_m_[i]);
  }
}

LawValues Laws::operator()(const Point& point) noexcept {
  LawValues out;
  pitch_.update(point.velocity_mps, point.turn_mps2);
  friction(point, out);
  stiffness(point.deflection_m, out);
  memory(point, out);
  return out;
}

}  // namespace dampline::effect
