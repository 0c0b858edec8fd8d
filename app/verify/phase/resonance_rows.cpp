// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cmath>

#include "app/verify/phase/rows.hpp"
#include "app/verify/phase/studies.hpp"

namespace dampline::app {
namespace {

constexpr double kPublishedViscous = 0.69;
constexpr double kPublishedCoulomb = 0.12;
constexpr double kPublishedStructural = 0.16;

struct SweepCase {
  const char* what;
  double published;
  sim::OscillatorLaw law;
  std::vector<double> swings_mps2;
  SweepBand band;
  const char* remark{""};
  double place_std_rad_s{0.0};  ///< of the peak, beside the sweep's step
};

std::vector<SweepCase> sweep_cases() {
  const SweepBand wide{.low_rad_s = 0.05, .high_rad_s = 1.5, .count = 30, .steps_per_period = 200};
  const SweepBand low{.low_rad_s = 0.02,
                      .high_rad_s = 1.0,
                      .count = 50,
                      .settle_periods = 10,
                      .steps_per_period = 1000};
  const SweepBand near{.low_rad_s = 0.04,
                       .high_rad_s = 0.4,
                       .count = 73,
                       .settle_periods = 40,
                       .steps_per_period = 1600};
  const double y_c = kStudyReversalM;
  return {
      {"Coulomb friction", kPublishedCoulomb, {.friction_mps2 = 1.0}, {0.5, 1.0, 1.2, 1.5}, wide},
      {"Coulomb friction",
       kPublishedCoulomb,
       {.friction_mps2 = 1.0},
       {1.005},
       near,
       "; the swing published is no larger than the friction; as it exceeds it by more, the peak "
       "moves from 0 to 1 rad/s, and half a per cent gives both published figures"},
      {"Coulomb friction, smoothed tanh(v / 0.5)",
       kPublishedCoulomb,
       {.friction_mps2 = 1.0, .creep_mps = 0.5},
       {0.5, 1.0},
       low},
      {"structural friction, magnitude |1 + y / y_c|",
       kPublishedStructural,
       {.friction_mps2 = 1.0, .reversal_m = y_c},
       {0.5, 1.0, 1.2, 1.5},
       wide},
      {"structural friction, magnitude |1 + y / y_c|",
       kPublishedStructural,
       {.friction_mps2 = 1.0, .reversal_m = y_c},
       {1.005},
       near,
       "; the same half per cent; it still creeps after 40 periods, and the peak's place depends "
       "on how long it may: 0.145 ... 0.175 rad/s",
       0.012},
      {"structural friction, 1 + y / y_c with its sign",
       kPublishedStructural,
       {.friction_mps2 = 1.0, .reversal_m = y_c, .may_turn_negative = true},
       {0.5, 1.0, 1.2},
       wide},
      {"structural friction with its sign, smoothed tanh(v / 0.5)",
       kPublishedStructural,
       {.friction_mps2 = 1.0, .reversal_m = y_c, .may_turn_negative = true, .creep_mps = 0.5},
       {0.5, 1.0},
       low}};
}

PhaseRow row_of(const SweepCase& c, double swing_mps2) {
  const AmplitudeSweep sweep = sweep_amplitude(c.law, swing_mps2, c.band);
  PhaseRow row{.table = "resonance",
               .what = fmt::format("{}, P1 = {}", c.what, swing_mps2),
               .unit = "rad/s",
               .published = c.published};
  const std::size_t at = sweep.largest();
  const double amplitude = sweep.amplitude_m[at];
  const double spacing = sweep.rate_rad_s[1] - sweep.rate_rad_s[0];
  if (amplitude == 0.0) {
    row.remark = "none: the input never exceeds the friction, nothing moves at any frequency";
  } else if (std::isinf(amplitude)) {
    row.remark = fmt::format(
        "none: friction that turns negative feeds energy in; unbounded from {:.2f} rad/s",
        sweep.rate_rad_s[at]);
  } else if (!sweep.has_peak_inside()) {
    row.remark = fmt::format("none: amplitude largest ({:.3f}) at the {} end of the sweep",
                             amplitude, at == 0 ? "low" : "high");
  } else {
    row.found = sweep.rate_rad_s[at];
    // A place known to one step of the sweep.
    row.deviation = std::hypot(spacing / std::sqrt(12.0), c.place_std_rad_s);
    row.remark = fmt::format("largest amplitude {:.3g}{}", amplitude, c.remark);
  }
  return row;
}

}  // namespace

std::vector<PhaseRow> resonance_rows() {
  const Resonance viscous = viscous_resonance();
  const double theory = std::sqrt(0.5);
  std::vector<PhaseRow> rows{{.table = "resonance",
                              .what = "viscous damping, c = 1",
                              .unit = "rad/s",
                              .published = kPublishedViscous,
                              .found = viscous.rate_rad_s.value,
                              .deviation = viscous.rate_rad_s.std,
                              .at_least = 0.995 * theory,
                              .at_most = 1.005 * theory,
                              .remark = "theory sqrt(1 - c^2 / 2) = 0.7071"}};
  for (const SweepCase& c : sweep_cases())
    for (const double swing : c.swings_mps2) rows.push_back(row_of(c, swing));
  return rows;
}

}  // namespace dampline::app
