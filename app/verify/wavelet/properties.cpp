// SPDX-License-Identifier: MIT
#include "app/verify/wavelet/properties.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "app/verify/wavelet/cases.hpp"
#include "app/verify/wavelet/recompute.hpp"
#include "app/verify/wavelet/rows.hpp"
#include "published/wavelet/coarse_rows.hpp"
#include "published/wavelet/daubechies.hpp"
#include "published/wavelet/estimates.hpp"

namespace dampline::app {
namespace {

using Duffing = SingleModel<DuffingTerms>;

/// What is promised of the recursive estimates at level 1 and 2.
constexpr Bound kQuantised{.error = 5e-4};
constexpr double kCodes = 4096.0;
/// Full scale over the largest value.
constexpr double kHeadroom = 1.1;

void quantise(std::vector<double>& values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  const double code = 2.0 * kHeadroom * largest / kCodes;
  for (double& value : values) value = code * std::round(value / code);
}

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

constexpr int kColumns = Duffing::kUnknowns + 1;
using Equation = MotionRow<Duffing>::Equation;
using Unknowns = Eigen::Matrix<double, Duffing::kUnknowns, 1>;

/// Batch least squares by Householder reflections with column pivoting.
Unknowns batch(const Equation* rows, std::size_t count) {
  Eigen::MatrixXd all{static_cast<Eigen::Index>(count), kColumns};
  for (std::size_t n = 0; n < count; ++n)
    all.row(static_cast<Eigen::Index>(n)) = rows[n].transpose();
  return all.leftCols<Duffing::kUnknowns>().colPivHouseholderQr().solve(
      all.col(Duffing::kUnknowns));
}

double largest_difference(const Unknowns& found, const Unknowns& batch) {
  return ((found - batch).array() / batch.array()).abs().maxCoeff();
}

constexpr Sufficiency kAnyFullRank{.tolerance = kLeastPivot, .rows_per_unknown = 1.0};

template <class Scalar>
double whole_run(const std::vector<Equation>& rows) {
  RecursiveEstimate<Duffing::kUnknowns, Scalar> estimate{0.0, kAnyFullRank};
  for (const Equation& row : rows) estimate.absorb(row.cast<Scalar>());
  if (!estimate.update()) return NAN;
  return largest_difference(estimate.latest().theta.template cast<double>(),
                            batch(rows.data(), rows.size()));
}

/// Every window that holds all its blocks in full.
template <class Scalar>
double sliding_window(const std::vector<Equation>& rows) {
  FactorRing<Duffing::kUnknowns, kBlocks, Scalar> ring{kBlockRows, kAnyFullRank};
  double worst = 0.0;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    ring.absorb(rows[n].cast<Scalar>());
    if (ring.rows() < static_cast<double>(kWindowRows)) continue;
    if (!ring.update()) return NAN;
    const Unknowns found = ring.latest().theta.template cast<double>();
    worst =
        std::max(worst, largest_difference(found, batch(&rows[n + 1 - kWindowRows], kWindowRows)));
  }
  return worst;
}

/// Factor between the published coefficients of variation and those found by D8 in windows of 32
/// rows: 1 is the same; the geometric mean over the parameters.
template <class M>
double cov_factor(PublishedCase published, const M& model, std::size_t samples) {
  published.resolution.samples = samples;
  const MethodResult found = over_windows<MotionRows<D8, M>>(
      measured<1>(published.simulate(), published.chain.mass_kg), model, kPublishedWindowRows);
  double sum = 0.0;
  for (std::size_t i = 0; i < found.value.size(); ++i) {
    const double cov = std::abs(found.std[i] / found.value[i]);
    sum += std::abs(std::log(cov / std::abs(published.parameters[i].spread->value)));
  }
  return std::exp(sum / static_cast<double>(found.value.size()));
}

double cov_factor_of_both(Drive drive, bool whole) {
  constexpr std::size_t kLevelNine = 512;
  const PublishedCase duffing = duffing_case(drive);
  const PublishedCase van_der_pol = van_der_pol_case(drive);
  const auto samples = [&](const PublishedCase& one) {
    return whole ? one.resolution.samples : kLevelNine;
  };
  return std::sqrt(cov_factor(duffing, Duffing{}, samples(duffing)) *
                   cov_factor(van_der_pol, SingleModel<VanDerPolTerms>{}, samples(van_der_pol)));
}

}  // namespace

CaseFigures quantised_duffing_result() {
  PublishedCase published = duffing_case(Drive::kHalfSlope);
  published.tables = {"noise"};
  published.title = "Duffing, forced, deflection and force in 12 bit";
  published.notes = {
      "Codes over 1.1 times the largest value. Level n: every signal and every "
      "regressor through the same n low-pass filters, step 0.05 s times 2^n."};
  for (PublishedParameter& parameter : published.parameters) parameter.spread.reset();
  auto truth = published.simulate();
  quantise(truth.deflection_m[0]);
  quantise(truth.force_n[0]);
  const auto input = measured<1>(truth, published.chain.mass_kg);
  const Duffing model;
  std::vector<MethodResult> results;
  const auto add = [&results](const char* method, const MethodResult& result) {
    results.push_back(result);
    results.back().method = method;
  };
  add("D8, level 0, windows of 32 rows", over_windows<MotionRows<D8, Duffing>>(input, model, 32));
  add("D8, level 0, recursive", over_run<MotionRows<D8, Duffing>>(input, model));
  add("D12, level 2, windows of 32 rows",
      over_windows<CoarseRows<D12, Duffing, 2>>(input, model, 32));
  const std::size_t first_bound = results.size();
  add("D8, level 1, recursive", over_run<CoarseRows<D8, Duffing, 1>>(input, model));
  add("D12, level 2, recursive", over_run<CoarseRows<D12, Duffing, 2>>(input, model));
  CaseFigures out = describe(published);
  out.own_methods = true;
  for (std::size_t m = 0; m < results.size(); ++m) {
    const Bound bound = m < first_bound ? Bound{} : kQuantised;
    for (std::size_t i = 0; i < published.parameters.size(); ++i) {
      out.parameters[i].estimates.push_back(
          make_estimate(results[m], i, published.parameters[i].truth, bound));
    }
  }
  return out;
}

std::vector<CheckGroup> sweep_readings() {
  const double half = cov_factor_of_both(Drive::kHalfSlope, true);
  const double equations = cov_factor_of_both(Drive::kEquations, true);
  return {{.tables = {"3", "4"},
           .title = "which sweep",
           .notes = {"Factor between the coefficients of variation found and published, geometric "
                     "mean over the six of table 3; 1: the same."},
           .checks = {{"phase of equations 21 to 23, whole sweep", "1", {}, equations, {}, {}},
                      {"half of that slope, whole sweep", "1", {}, half, equations, {}},
                      {"phase of equations 21 to 23, 512 samples (level j = 9)",
                       "1",
                       {},
                       cov_factor_of_both(Drive::kEquations, false),
                       {},
                       {}},
                      {"half of that slope, 512 samples (level j = 9)",
                       "1",
                       {},
                       cov_factor_of_both(Drive::kHalfSlope, false),
                       {},
                       {}}}}};
}

std::vector<CheckGroup> stiffness_drop() {
  PublishedCase published = duffing_case(Drive::kHalfSlope);
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

std::vector<CheckGroup> recursive_against_batch() {
  const PublishedCase published = duffing_case(Drive::kHalfSlope);
  const auto input = measured<1>(published.simulate(), published.chain.mass_kg);
  std::vector<Equation> rows;
  for_each_row<MotionRows<D8, Duffing>>(
      input, Duffing{}, [&](const MotionRow<Duffing>& row) { rows.push_back(row.equation(0)); });
  return {{.tables = {"precision"},
           .title = "recursive against batch least squares",
           .notes = {"Duffing, forced, D8; largest relative difference of a parameter from batch "
                     "least squares in double (Householder). Rows are formed in double."},
           .checks = {{"whole run, double", "1", {}, whole_run<double>(rows), 1e-12, {}},
                      {"whole run, single", "1", {}, whole_run<float>(rows), {}, {}},
                      {"windows of 32 rows, ring of 4 factors, double",
                       "1",
                       {},
                       sliding_window<double>(rows),
                       1e-10,
                       {}},
                      {"windows of 32 rows, ring of 4 factors, single",
                       "1",
                       {},
                       sliding_window<float>(rows),
                       {},
                       {}}}}};
}

}  // namespace dampline::app
