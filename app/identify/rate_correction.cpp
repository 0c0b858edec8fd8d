// SPDX-License-Identifier: MIT
#include "app/identify/rate_correction.hpp"

#include <fmt/format.h>

#include <cmath>

#include "app/error.hpp"

namespace dampline::app {
namespace {

Estimate scaled(const Estimate& estimate, double factor) {
  return {estimate.value * factor, estimate.std * factor};
}

}  // namespace

Snapshot corrected(const Snapshot& snapshot, const RateCorrection& correction) {
  Snapshot out = snapshot;
  out.stiffness_npm = scaled(snapshot.stiffness_npm, correction.stiffness());
  out.stiffness_with_viscous_npm =
      scaled(snapshot.stiffness_with_viscous_npm, correction.stiffness());
  out.law_width_with_viscous_mps =
      scaled(snapshot.law_width_with_viscous_mps, correction.velocity());
  out.viscous_nspm = scaled(snapshot.viscous_nspm, correction.viscous());
  out.law_width_mps = scaled(snapshot.law_width_mps, correction.velocity());
  for (CurvePoint& point : out.curve) point.velocity_mps *= correction.velocity();
  out.velocity_rms_mps *= correction.velocity();
  return out;
}

RateCorrection make_correction(const MeasuredRate& measured, double nominal_hz,
                               const std::string& source) {
  if (!(measured.rate_hz > 0.0)) return {};
  const RateCorrection correction{measured.rate_hz / nominal_hz};
  if (!(std::fabs(correction.ratio - 1.0) <= RateCorrection::kMost))
    throw RunError{
        fmt::format("{}: sampled at {:.3f} Hz by its own time, but [input] sample_rate_hz is "
                    "{:.3f}; set it to the "
                    "record's rate (at most {:g} % apart)",
                    source, measured.rate_hz, nominal_hz, 100.0 * RateCorrection::kMost)};
  return correction;
}

}  // namespace dampline::app
