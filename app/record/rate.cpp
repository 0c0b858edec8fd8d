// SPDX-License-Identifier: MIT
#include "app/record/rate.hpp"

#include <fmt/format.h>

#include <cmath>

#include "app/config/config.hpp"
#include "app/error.hpp"
#include "app/record/rows.hpp"
#include "dampline/motion/decimator.hpp"

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
  if (measured.rate_hz > InputConfig::kHighestRateHz)
    throw RunError{fmt::format(
        "{}: sampled at {:.3g} Hz by its own time, which no sensor is ([input] sample_rate_hz is "
        "{:.3f}): frames come in bursts of more than {:g} instants, or times are not in s",
        source, measured.rate_hz, nominal_hz, CounterSequence::kBurstTicks)};
  if (!(std::fabs(correction.ratio - 1.0) <= RateCorrection::kMost))
    throw RunError{
        fmt::format("{}: sampled at {:.3f} Hz by its own time, but [input] sample_rate_hz is "
                    "{:.3f}; set it to the "
                    "record's rate (at most {:g} % apart)",
                    source, measured.rate_hz, nominal_hz, 100.0 * RateCorrection::kMost)};
  return correction;
}

Config with_record_rate(Config config, const SourceOptions& source, SourceKind kind) {
  if (config.input.sample_rate_is_set || kind != SourceKind::kTruckRows) return config;
  if (const double rate_hz = TruckRows{config.input, config.car.extras(), source}.first_rate_hz();
      rate_hz > 0.0)
    config.input.sample_rate_hz = rate_hz;
  return config;
}

double truck_rate_hz(const InputConfig& input) {
  return input.sample_rate_hz / decimation(input.sample_rate_hz);
}

}  // namespace dampline::app
