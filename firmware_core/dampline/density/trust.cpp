// SPDX-License-Identifier: MIT
#include "dampline/density/trust.hpp"

namespace dampline {

const char* text(Reason reason) noexcept {
  switch (reason) {
    case Reason::kNoMotion:
      return "the suspension does not move";
    case Reason::kConstantChannel:
      return "an acceleration is constant";
    case Reason::kShortRecord:
      return "too little time in motion";
    case Reason::kNarrowMotion:
      return "too few velocities are visited on both sides";
    case Reason::kRangeClips:
      return "the histograms' range leaves out too much of the motion";
    case Reason::kColouredInput:
      return "the input is not white";
    case Reason::kDependence:
      return "deflection and velocity are not independent";
    case Reason::kNonStationary:
      return "the motion is not stationary";
    case Reason::kBentCurve:
      return "its force falls towards slow motion, as where the frame pitches";
    case Reason::kNotSolvable:
      return "its equations have no solution";
  }
  return "";
}

const char* unit(Reason reason) noexcept {
  switch (reason) {
    case Reason::kNoMotion:
      return "m/s";
    case Reason::kConstantChannel:
      return "m/s^2";
    case Reason::kShortRecord:
      return "s";
    case Reason::kColouredInput:
      return "dB";
    case Reason::kNarrowMotion:
    case Reason::kRangeClips:
    case Reason::kDependence:
    case Reason::kNonStationary:
    case Reason::kBentCurve:
    case Reason::kNotSolvable:
      return "";
  }
  return "";
}

void TrustVerdict::require_at_least(Reason reason, double size, double limit) noexcept {
  findings[static_cast<std::size_t>(reason)] = {
      .checked = true, .violated = !(size >= limit), .size = size, .limit = limit};
}

void TrustVerdict::require_at_most(Reason reason, double size, double limit) noexcept {
  findings[static_cast<std::size_t>(reason)] = {
      .checked = true, .violated = !(size <= limit), .size = size, .limit = limit};
}

bool TrustVerdict::first_violation(Reason& reason) const noexcept {
  for (std::size_t i = 0; i < kReasons; ++i) {
    if (!findings[i].violated) continue;
    reason = static_cast<Reason>(i);
    return true;
  }
  return false;
}

}  // namespace dampline
