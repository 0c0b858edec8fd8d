// SPDX-License-Identifier: MIT
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "app/verify/wavelet/models.hpp"
#include "app/verify/wavelet/properties.hpp"
#include "app/verify/wavelet/published_case.hpp"
#include "app/verify/wavelet/rows.hpp"
#include "published/wavelet/daubechies.hpp"
#include "published/wavelet/factor_ring.hpp"
#include "published/wavelet/recursive_estimate.hpp"

namespace dampline::app {
namespace {

using Duffing = SingleModel<DuffingTerms>;
constexpr int kColumns = Duffing::kUnknowns + 1;
constexpr std::size_t kWindowRows = 32;
constexpr std::size_t kBlocks = 4;
constexpr std::int64_t kBlockRows = kWindowRows / kBlocks;
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

}  // namespace

std::vector<CheckGroup> recursive_against_batch() {
  const PublishedCase published = duffing_case(true);
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
