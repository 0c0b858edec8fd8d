// SPDX-License-Identifier: MIT
#include "app/verify/phase/rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/verify/phase/studies.hpp"
#include "app/verify/printed/printed.hpp"
#include "published/phase/scaling.hpp"

namespace dampline::app {
namespace {

/// As printed; the resonances of the three models.
double published(const char* model) {
  return printed_table(phase_mappings(), "resonance").at("omega", model).value;
}

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
      {"Coulomb friction",
       published("Coulomb"),
       {.friction_mps2 = 1.0},
       {0.5, 1.0, 1.2, 1.5},
       wide},
      {"Coulomb friction",
       published("Coulomb"),
       {.friction_mps2 = 1.0},
       {1.005},
       near,
       "; the swing published is no larger than the friction; as it exceeds it by more, the peak "
       "moves from 0 to 1 rad/s, and half a per cent gives both published figures"},
      {"Coulomb friction, smoothed tanh(v / 0.5)",
       published("Coulomb"),
       {.friction_mps2 = 1.0, .creep_mps = 0.5},
       {0.5, 1.0},
       low},
      {"structural friction, magnitude |1 + y / y_c|",
       published("structural"),
       {.friction_mps2 = 1.0, .reversal_m = y_c},
       {0.5, 1.0, 1.2, 1.5},
       wide},
      {"structural friction, magnitude |1 + y / y_c|",
       published("structural"),
       {.friction_mps2 = 1.0, .reversal_m = y_c},
       {1.005},
       near,
       "; the same half per cent; it still creeps after 40 periods, and the peak's place depends "
       "on how long it may: 0.145 ... 0.175 rad/s",
       0.012},
      {"structural friction, 1 + y / y_c with its sign",
       published("structural"),
       {.friction_mps2 = 1.0, .reversal_m = y_c, .may_turn_negative = true},
       {0.5, 1.0, 1.2},
       wide},
      {"structural friction with its sign, smoothed tanh(v / 0.5)",
       published("structural"),
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

struct System {
  const char* name;
  bool linear;
  bool keeps_moving;  ///< has a steady motion under the drives of the test of two amplitudes
  sim::OscillatorLaw law;
};

std::vector<System> systems() {
  return {{"linear, c = 0.1", true, true, {.viscous_per_s = 0.1}},
          {"linear, c = 0.3", true, true, {.viscous_per_s = 0.3}},
          {"linear, c = 1", true, true, {.viscous_per_s = 1.0}},
          {"Coulomb 0.05 on c = 0.3", false, true, {.viscous_per_s = 0.3, .friction_mps2 = 0.05}},
          {"Coulomb 0.2 on c = 0.3", false, true, {.viscous_per_s = 0.3, .friction_mps2 = 0.2}},
          {"Coulomb 1", false, true, {.friction_mps2 = 1.0}},
          {"structural 0.3, y_c = 5, on c = 0.3",
           false,
           true,
           {.viscous_per_s = 0.3, .friction_mps2 = 0.3, .reversal_m = 5.0}},
          {"structural 1, y_c = 0.5",
           false,
           false,
           {.friction_mps2 = 1.0, .reversal_m = kStudyReversalM}},
          {"cubic 0.1 on c = 0.3", false, true, {.viscous_per_s = 0.3, .cubic_per_m2s2 = 0.1}}};
}

std::uint64_t seed(int run) { return 2000U + static_cast<std::uint64_t>(run); }

PhaseRow share_row(const char* table, const std::string& what, int hits, int runs, bool judged) {
  const double share = static_cast<double>(hits) / runs;
  PhaseRow row{.table = table,
               .what = what,
               .unit = "of runs",
               .found = share,
               .deviation = std::sqrt(share * (1.0 - share) / runs),
               .remark = fmt::format("{} of {} runs", hits, runs)};
  if (judged) row.at_least = 0.99;
  return row;
}

int right_by_sections(const System& s, double noise, int runs) {
  const auto wanted = s.linear ? PlanarityState::kLinear : PlanarityState::kNonlinear;
  int right = 0;
  for (int run = 0; run < runs; ++run)
    right += study_planarity(s.law, noise, seed(run)).state == wanted ? 1 : 0;
  return right;
}

int right_by_scaling(const System& s, double noise, int runs) {
  const auto wanted = s.linear ? ScalingState::kProportional : ScalingState::kDisproportional;
  int right = 0;
  for (int run = 0; run < runs; ++run)
    right += study_scaling(s.law, noise, seed(run)).state == wanted ? 1 : 0;
  return right;
}

PhaseRow mean_row(const std::string& what, const RunningMean& mean, std::optional<double> at_most,
                  const std::string& remark) {
  return {.table = "friction",
          .what = what,
          .found = mean.mean(),
          .deviation = std::sqrt(mean.variance()),
          .at_most = at_most,
          .remark = remark};
}

}  // namespace

std::vector<PhaseRow> resonance_rows() {
  const Resonance viscous = viscous_resonance();
  const double theory = std::sqrt(0.5);
  std::vector<PhaseRow> rows{{.table = "resonance",
                              .what = "viscous damping, c = 1",
                              .unit = "rad/s",
                              .published = published("viscous"),
                              .found = viscous.rate_rad_s.value,
                              .deviation = viscous.rate_rad_s.std,
                              .at_least = 0.995 * theory,
                              .at_most = 1.005 * theory,
                              .remark = "theory sqrt(1 - c^2 / 2) = 0.7071"}};
  for (const SweepCase& c : sweep_cases())
    for (const double swing : c.swings_mps2) rows.push_back(row_of(c, swing));
  return rows;
}

std::vector<PhaseRow> planarity_rows(int runs) {
  std::vector<PhaseRow> rows;
  for (const System& s : systems()) {
    for (const double noise : {0.0, 0.01, 0.05}) {
      RunningMean one;
      RunningMean all;
      for (int run = 0; run < runs; ++run) {
        const PlanarityIndices index = study_indices(s.law, noise, seed(run));
        one.add(index.one_phase);
        all.add(index.all_phases);
      }
      rows.push_back({.table = "planarity",
                      .what = fmt::format("{}, noise {:.0f} %", s.name, 100.0 * noise),
                      .unit = "rms distance / rms a",
                      .found = all.mean(),
                      .deviation = std::sqrt(all.variance()),
                      .remark = fmt::format("one phase alone: {:.4f}", one.mean())});
    }
  }
  return rows;
}

std::vector<PhaseRow> linearity_rows(int runs) {
  std::vector<PhaseRow> rows;
  for (const System& s : systems()) {
    for (const double noise : {0.01, 0.05}) {
      const std::string what = fmt::format("{} declared {} at {:.0f} % noise", s.name,
                                           s.linear ? "linear" : "non-linear", 100.0 * noise);
      rows.push_back(share_row("linearity", what + ", sections", right_by_sections(s, noise, runs),
                               runs, noise < 0.02));
      const bool judged = noise < 0.02 && s.keeps_moving;
      PhaseRow scaling = share_row("linearity", what + ", two amplitudes",
                                   right_by_scaling(s, noise, runs), runs, judged);
      if (!s.keeps_moving)
        scaling.remark +=
            "; its friction grows faster than its spring, so it locks: no steady motion";
      rows.push_back(scaling);
    }
  }
  return rows;
}

std::vector<PhaseRow> friction_rows(int runs) {
  std::vector<PhaseRow> rows;
  struct Case {
    double noise{0.0};
    int phases{8};
    std::optional<double> most{};
  };
  for (const Case& c : {Case{0.0, 8, 0.015}, Case{0.01, 8, 0.015}, Case{0.05, 8, 0.035},
                        Case{0.01, 2, std::nullopt}}) {
    RunningMean g, r, inside, friction, reversal, stiffness;
    for (int run = 0; run < runs; ++run) {
      const FrictionStudy study = study_friction(c.noise, seed(run), c.phases);
      g.add(study.friction_error);
      r.add(study.restoring_error);
      inside.add(static_cast<double>(study.friction_inside) / study.nodes);
      friction.add(std::abs(study.law.friction_mps2.value - 1.0));
      reversal.add(std::abs(study.law.reversal_m.value / kStudyReversalM - 1.0));
      stiffness.add(std::abs(study.law.stiffness_per_s2.value - 1.0));
    }
    const std::string at = fmt::format("{:.0f} % noise, {} phases", 100.0 * c.noise, c.phases);
    const bool judged = c.phases == 8 && c.noise < 0.02;
    const auto bound = [&](double x) { return judged ? std::optional{x} : std::nullopt; };
    rows.push_back(mean_row(
        "g(y), relative error, " + at, g, c.most,
        fmt::format("{:.0f} % of the nodes within 2 stated deviations", 100.0 * inside.mean())));
    rows.push_back(mean_row("r(y), relative error, " + at, r, std::nullopt, ""));
    rows.push_back(mean_row("H1, magnitude of relative error, " + at, friction, bound(0.005), ""));
    rows.push_back(mean_row("y_c, magnitude of relative error, " + at, reversal, bound(0.02), ""));
    rows.push_back(mean_row("k, magnitude of relative error, " + at, stiffness, std::nullopt, ""));
  }
  return rows;
}

namespace {

/// One curve of the publication's figures 2 and 4: g over y, and how much of the motion sticks.
void add_curve(const std::string& name, const FrictionFamily::Curve& curve,
               std::vector<PhaseRow>& rows) {
  constexpr double kEveryM = 0.75;
  constexpr double kWithinM = 3.0;
  const FrictionStudy& rest = curve.rest;
  const FrictionStudy& study = curve.started;
  PhaseRow stuck{.table = "figures",
                 .what = "share of flashes that stick, from rest, " + name,
                 .found = rest.stuck_share()};
  if (rest.points == 0)
    stuck.remark = "none moves: nothing can be estimated from rest";
  else
    stuck.remark = fmt::format("{} flashes move, {} of {} nodes resolved", rest.points, rest.nodes,
                               kStudyNodes);
  rows.push_back(stuck);
  rows.push_back({.table = "figures",
                  .what = "g(y), relative error, from 24 starts within 3, " + name,
                  .found = study.nodes > 0 ? std::optional{study.friction_error} : std::nullopt,
                  .at_most = 0.03,
                  .remark = fmt::format("{:.0f} % of the flashes stick and are left out; {} nodes",
                                        100.0 * study.stuck_share(), study.nodes)});
  for (const FrictionNode& node : study.curve.nodes) {
    const bool shown = std::abs(std::remainder(node.deflection_m, kEveryM)) < 1e-9;
    if (!shown || std::abs(node.deflection_m) > kWithinM) continue;
    PhaseRow row{.table = "figures",
                 .what = fmt::format("g({:+.2f}), {}", node.deflection_m, name),
                 .published = std::abs(1.0 + node.deflection_m / kStudyReversalM)};
    if (node.resolved) {
      row.found = node.friction_mps2.value;
      row.deviation = node.friction_mps2.std;
    } else {
      row.remark = "none: nothing moves there, or one way only";
    }
    rows.push_back(row);
  }
}

}  // namespace

std::vector<PhaseRow> figure_rows(const std::vector<FrictionFamily>& families) {
  std::vector<PhaseRow> rows;
  for (const FrictionFamily& family : families)
    for (const FrictionFamily::Curve& curve : family.curves)
      add_curve(fmt::format("{} = {}", family.name, curve.value), curve, rows);
  return rows;
}

}  // namespace dampline::app
