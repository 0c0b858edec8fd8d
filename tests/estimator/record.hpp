// SPDX-License-Identifier: MIT
#pragma once
#include <bit>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "dampline/damping/estimator.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline {

inline constexpr double kLadenMassKg = 37200.0;
inline constexpr double kLadenStiffnessNpm = 5.26e6;
inline constexpr double kLadenCoulombN = 0.5 * (7562.0 + 9150.0);

inline std::vector<Sample> simulate(const sim::SimulationConfig& config, double length_s) {
  sim::Simulation simulation{config};
  std::vector<Sample> out;
  for (int i = 0; i < static_cast<int>(length_s * sim::kSampleRateHz); ++i)
    out.push_back(sim::to_sample(simulation.next()));
  return out;
}

/// A laden car at 80 km/h for 100 s: made once, then shared.
inline const std::vector<Sample>& laden_record() {
  static const std::vector<Sample> record =
      simulate(sim::reference_run(sim::Load::kLaden, 80.0, 4711), 100.0);
  return record;
}

struct Identified {
  Snapshot snapshot;
  std::vector<BlockReport> reports;
};

/// Runs a record; `before(i)` is called ahead of sample i.
inline Identified identify(const std::vector<Sample>& record, const EstimatorConfig& config = {},
                           const std::function<void(Estimator&, std::size_t)>& before = {}) {
  const auto identifier = std::make_unique<Estimator>(config);
  Identified out;
  for (std::size_t i = 0; i < record.size(); ++i) {
    if (before) before(*identifier, i);
    const UpdateResult result = identifier->update(record[i]);
    if (result.block_closed) out.reports.push_back(result.block);
  }
  identifier->finish();
  BlockReport report;
  while (identifier->next_report(report)) out.reports.push_back(report);
  out.snapshot = identifier->snapshot();
  return out;
}

/// Every number of the estimate, as bits: equal means bit-identical. Counts are left out.
inline std::vector<std::uint64_t> bits_of(const Snapshot& s) {
  std::vector<double> x{s.curve_force_at_zero_n, s.nmse,       s.held_out_nmse, s.velocity_rms_mps,
                        s.stick_share,           s.noise_mps2, s.excitation};
  for (const Estimate& e :
       {s.coulomb_n, s.stiffness_npm, s.law_width_mps, s.viscous_nspm, s.coulomb_with_viscous_n}) {
    x.push_back(e.value);
    x.push_back(e.std);
  }
  for (const CurvePoint& p : s.curve) {
    x.push_back(p.force_n);
    x.push_back(p.std_n);
    x.push_back(static_cast<double>(p.samples));
  }
  std::vector<std::uint64_t> out;
  for (const double v : x) out.push_back(std::bit_cast<std::uint64_t>(v));
  out.push_back(s.blocks_in_estimate);
  out.push_back(s.std_is_lower_bound ? 1U : 0U);
  return out;
}

}  // namespace dampline
