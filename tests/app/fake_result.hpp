// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <numbers>

#include "app/run/result.hpp"

namespace dampline::app {

/// Three Gaussian planes and a section of phase 0.
inline std::shared_ptr<const PhaseSnapshot> fake_phase() {
  auto phase = std::make_shared<PhaseSnapshot>();
  for (PhasePicture* picture : {&phase->velocity_over_deflection, &phase->accel_over_deflection,
                                &phase->accel_over_velocity}) {
    *picture = {PictureState::kGood, -2e-3, 2e-3, -0.05, 0.05, 90000, 0.001, {}};
    for (int i = 0; i < 64; ++i) {
      for (int j = 0; j < 64; ++j) {
        const double r2 = 0.01 * ((i - 31.5) * (i - 31.5) + (j - 31.5) * (j - 31.5));
        if (r2 < 9.0)
          picture->density[std::size_t(i)][std::size_t(j)] = float(3e4 * std::exp(-0.5 * r2));
      }
    }
  }
  phase->period = {PeriodState::kFound, 0.37, 0.002, 0.8, 0.97, 0.999};
  phase->section_count[0] = 2;
  phase->section[0][0] = {1e-3, 0.02, -0.4};
  phase->section[0][1] = {1.1e-3, 0.019, -0.5};
  phase->still = 7;
  return phase;
}

/// A truck's result with everything in it, made from closed formulas: nothing was identified.
inline RunResult fake_result() {
  RunResult r;
  r.kind = "truck";
  r.headline = "Dry friction of 8 351 N ± 14 N on a spring of 5.262 MN/m ± 0.016 MN/m.";
  r.trust = Trust::kTrusted;
  r.model = {"linear spring", "coulomb"};
  r.parameters = {{"coulomb", 8351.2, 14.3, "N"},
                  {"stiffness", 5.262e6, 1.6e4, "N/m"},
                  {"viscous", 120.0, 340.0, "N s/m"},
                  {"law_width", 1.62e-3, 2.1e-4, "m/s"}};
  r.counts = {
      {"samples", 90000}, {"gaps", 2}, {"lost", 31}, {"blocks", 150}, {"blocks_excluded", 4}};
  r.fit = {0.0112, 0.1058, 0.0115};
  r.stick_share = 0.031;
  r.excitation = 0.97;
  r.asymmetry = "not observable from accelerations";
  r.sample_rate_hz = Estimate{299.9987, 0.0004};
  r.latency_s = 2.65;
  r.duration_s = 300.0;
  r.notes = {"Columns that were not used: <speed_kmh>."};
  const double nodes[] = {3e-3, 6e-3, 10e-3, 15e-3, 22e-3, 30e-3, 42e-3, 60e-3};
  for (int i = 7; i >= 0; --i)
    r.curve.push_back(
        {-nodes[i], -8351.0 + 30.0 * i, 18.0 + 12.0 * i, std::uint64_t(9000 / (1 + i * i))});
  r.curve.push_back({0.0, -8200.0, 40.0, 0});
  r.curve.push_back({0.0, 8200.0, 40.0, 0});
  for (int i = 0; i < 8; ++i)
    r.curve.push_back(
        {nodes[i], 8351.0 - 30.0 * i, 18.0 + 12.0 * i, std::uint64_t(9100 / (1 + i * i))});
  MethodSummary weak{"fokker_planck_weak",
                     "Fokker-Planck, weak form",
                     {5120.0, 90.0},
                     true,
                     false,
                     {{"the input is not white: <comb>", 14.2, 6.0, "dB"}},
                     {}};
  MethodSummary known{"known_input", "known input", {8290.0, 60.0}, true, true, {}, {}};
  for (const CurveRow& row : r.curve) {
    weak.curve_n.push_back({0.6 * row.force_n, 90.0});
    known.curve_n.push_back({0.99 * row.force_n, 60.0});
  }
  weak.curve_n[0] = {std::nan(""), std::nan("")};  // no support
  r.methods = {weak, known};
  for (const char* quantity : {"deflection_m", "velocity_mps"}) {
    DensityTable table{quantity, 0.002, {}};
    for (int i = -20; i <= 20; ++i)
      table.rows.push_back({2e-4 * i, 800.0 * std::exp(-0.01 * i * i), 100.0});
    r.densities.push_back(table);
  }
  r.phase = fake_phase();
  r.convergence.names = {"coulomb", "stiffness"};
  r.convergence.units = {"N", "N/m"};
  for (int i = 1; i <= 75; ++i) {
    const double t = 4.0 * i;
    const double s = 1.0 / std::sqrt(t);
    r.convergence.rows.push_back({t,
                                  {{8351.0 + 240.0 * s * std::sin(0.3 * t), 250.0 * s},
                                   {5.262e6 + 3e5 * s * std::cos(0.2 * t), 2.7e5 * s}}});
  }
  for (int i = 0; i < 6000; ++i) {
    const double t = 30.0 + i / 300.0;
    const double w = 2.0 * std::numbers::pi * 2.7;
    const double a = 0.8e-3 * (1.0 + 0.5 * std::sin(t));
    r.motion.push_back({t, a * std::sin(w * t), a * w * std::cos(w * t)});
  }
  r.excluded = {{41.0, 45.1, "gap"}, {120.0, 122.0, "saturated"}, {200.0, 202.0, "gap"}};
  return r;
}

/// How a live run kept up: frames around 200 us, and one that was 5.6 ms late.
inline void make_live(RunResult& r) {
  LiveFigures live;
  live.state = "ended";
  live.lateness_p50_us = 238.0;
  live.lateness_p90_us = 301.0;
  live.lateness_p99_us = 557.0;
  live.lateness_p999_us = 1900.0;
  live.lateness_max_us = 5600.0;
  r.live = live;
  for (int i = 0; i < 40; ++i) {
    const double from_us = 96.0 * std::exp2(i / 16.0);
    r.lateness.push_back({from_us, 96.0 * std::exp2((i + 1) / 16.0),
                          std::uint64_t(1.0 + 9000.0 * std::exp(-0.02 * (i - 21) * (i - 21)))});
  }
  r.lateness.push_back({5500.0, 5740.0, 1});
}

}  // namespace dampline::app
