// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/verify/wavelet/models.hpp"
#include "app/verify/wavelet/properties.hpp"
#include "app/verify/wavelet/recompute.hpp"
#include "published/wavelet/coarse_rows.hpp"

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

}  // namespace

CaseFigures quantised_duffing_result() {
  PublishedCase published = duffing_case(true);
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

}  // namespace dampline::app
