// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdint>
#include <vector>

#include "app/verify/wavelet/models.hpp"
#include "app/verify/wavelet/properties.hpp"
#include "app/verify/wavelet/published_case.hpp"
#include "app/verify/wavelet/rows.hpp"
#include "published/wavelet/daubechies.hpp"
#include "published/wavelet/factor_ring.hpp"

namespace dampline::app {
namespace {

using Duffing = SingleModel<DuffingTerms>;
using Rows = MotionRows<D8, Duffing>;

constexpr int kBlockRows = 8;
constexpr int kBlocks = 4;
constexpr int kWindowRows = kBlocks * kBlockRows;
/// Samples that a window of rows sees.
constexpr double kWindowSamples = kWindowRows + 2.0 * Rows::kLatency;
constexpr int kStiffness = 1;  ///< of the unknowns c, k, k3
constexpr double kBeforeNpm = 1.0;
constexpr double kAfterNpm = 0.8;
constexpr double kTolerance = 1e-4;

/// Stiffness of the newest window after each sample from `first` on.
struct Tracked {
  std::int64_t sample;
  double stiffness_npm;
};

std::vector<Tracked> track(const Measured<1>& input) {
  FactorRing<Duffing::kUnknowns, kBlocks> window{
      kBlockRows, {.tolerance = kLeastPivot, .rows_per_unknown = 1.0}};
  std::vector<Tracked> out;
  for_each_row<Rows>(input, Duffing{}, [&](const MotionRow<Duffing>& row) {
    window.absorb(row.equation(0));
    if (window.rows() <= kWindowRows - kBlockRows) return;
    const double found = window.update() ? window.latest().theta[kStiffness] : NAN;
    out.push_back({row.sample + static_cast<std::int64_t>(Rows::kLatency), found});
  });
  return out;
}

}  // namespace

std::vector<CheckGroup> stiffness_drop() {
  PublishedCase published = duffing_case(true);
  const std::size_t change = published.resolution.samples / 2;
  const double step_s = published.resolution.step_s;
  published.chain.change_time_s = static_cast<sim::reference::Real>(change) * step_s;
  published.chain.stiffness_factor = 0.8L;
  const auto tracked = track(measured<1>(published.simulate(), published.chain.mass_kg));
  double worst_before = 0.0;
  double first_after_npm = NAN;
  double samples_to_settle = 0.0;
  for (const Tracked& one : tracked) {
    const double since = static_cast<double>(one.sample) - static_cast<double>(change);
    // The sample at the change still belongs to both.
    if (since <= 0) {
      worst_before = std::fmax(worst_before, std::abs(one.stiffness_npm / kBeforeNpm - 1.0));
    }
    if (since == kWindowSamples) first_after_npm = one.stiffness_npm;
    if (!(std::abs(one.stiffness_npm / kAfterNpm - 1.0) <= kTolerance) && since > 0)
      samples_to_settle = since + 1.0;
  }
  return {
      {.tables = {"step"},
       .title = "stiffness that drops by 20 % in the middle of the run, tracked",
       .notes = {published.conditions,
                 "D8, a sliding window of at most 32 rows (44 samples of 0.05 s), a ring of four "
                 "factors. "
                 "The stiffness drops from 1 to 0.8 N/m."},
       .checks = {
           {"largest relative error of k before the drop", "1", {}, worst_before, kTolerance, {}},
           {"samples until k is within 1e-4 of its new value, for good",
            "1",
            {},
            samples_to_settle,
            kWindowSamples + 1.0,
            {}},
           {"k by the first window after the drop",
            "N/m",
            {},
            first_after_npm,
            kAfterNpm * (1.0 + kTolerance),
            kAfterNpm * (1.0 - kTolerance)}}}};
}

}  // namespace dampline::app
