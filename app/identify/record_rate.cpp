// SPDX-License-Identifier: MIT
#include "app/identify/record_rate.hpp"

#include "app/identify/thinner.hpp"
#include "app/identify/truck_rows.hpp"

namespace dampline::app {

Config with_record_rate(Config config, const SourceOptions& source, SourceKind kind) {
  if (config.input.sample_rate_is_set || kind != SourceKind::kTruckCsv) return config;
  if (const double rate_hz = TruckRows{config.input, source}.first_rate_hz(); rate_hz > 0.0)
    config.input.sample_rate_hz = rate_hz;
  return config;
}

double truck_rate_hz(const InputConfig& input) {
  return input.sample_rate_hz / thinning(input.sample_rate_hz);
}

}  // namespace dampline::app
