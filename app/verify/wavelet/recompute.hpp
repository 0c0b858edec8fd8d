// SPDX-License-Identifier: MIT
#pragma once
#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "app/verify/wavelet/cases.hpp"
#include "app/verify/wavelet/figures.hpp"
#include "app/verify/wavelet/rows.hpp"
#include "published/wavelet/daubechies.hpp"
#include "published/wavelet/estimates.hpp"

namespace dampline::app {

/// What is promised of a case. D12 in windows keeps `d12` and, of a smooth case, a share of the
/// published coefficient of variation; D16 over the whole run keeps `d16`. Faint parameters have
/// bounds of their own.
struct Promise {
  Bound d8, faint_d8, d12;
  double d16_error{0.0}, faint_d16_error{0.0};
  double of_published{0.0};  ///< 0: no share

  [[nodiscard]] Bound d12_for(const PublishedParameter& parameter) const noexcept {
    Bound out = d12;
    if (of_published > 0.0 && parameter.spread)
      out.spread = of_published * std::abs(parameter.spread->value);
    return out;
  }
};
inline constexpr Promise kSmooth{{1e-5, 5e-5}, {1e-2, 1e-1}, {.error = 1e-6}, 1e-8, 1e-7, 0.1};
/// The sweep of equations 21 to 23 ends twice as fast as the other: fewer samples a period.
inline constexpr Promise kFastSweep{{5e-5, 1e-4}, {1e-2, 1e-1}, {.error = 1e-6}, 1e-8, 1e-7, 1.0};
[[nodiscard]] constexpr Promise friction_promise(double error, double spread) {
  const Bound bound{error, spread};
  return {bound, bound, bound, 1e-8, 1e-8, 0.0};
}

/// Estimates of one method for every unknown.
struct MethodResult {
  std::string method;
  std::vector<double> value;
  std::vector<double> std;
  std::size_t rows{0};
  std::size_t windows{0};
};

/// Least squares over sequential sets of `window_rows` equations; an instant of two masses has two.
template <class Rows, class M>
[[nodiscard]] MethodResult over_windows(const Measured<M::kDof>& measured, const M& model,
                                        std::size_t window_rows, Gate gate = Gate::kOn) {
  MethodResult out;
  SequentialWindows<M::kUnknowns> windows{static_cast<std::int64_t>(window_rows), kLeastPivot};
  const auto take = [&](const MotionRow<M>& row) {
    out.rows += M::kDof;
    for (int d = 0; d < M::kDof; ++d) windows.absorb(row.equation(d));
  };
  for_each_row<Rows>(measured, model, take, gate);
  out.windows = static_cast<std::size_t>(windows.scatter().count());
  const auto deviation = windows.scatter().deviation();
  for (int i = 0; i < M::kUnknowns; ++i) {
    out.value.push_back(windows.scatter().mean()[i]);
    out.std.push_back(out.windows < 2 ? NAN : deviation[i]);
  }
  return out;
}

/// Recursive least squares over the whole run; deviations from the residual.
template <class Rows, class M>
[[nodiscard]] MethodResult over_run(const Measured<M::kDof>& measured, const M& model) {
  MethodResult out;
  RecursiveEstimate<M::kUnknowns> estimate{0.0, {.tolerance = kLeastPivot}};
  for_each_row<Rows>(measured, model, [&](const MotionRow<M>& row) {
    out.rows += M::kDof;
    for (int d = 0; d < M::kDof; ++d) estimate.absorb(row.equation(d));
  });
  const bool solved = estimate.update();
  for (int i = 0; i < M::kUnknowns; ++i) {
    out.value.push_back(solved ? estimate.latest().theta[i] : NAN);
    out.std.push_back(solved ? estimate.latest().deviation[i] : NAN);
  }
  return out;
}

[[nodiscard]] Estimate make_estimate(const MethodResult& result, std::size_t unknown, double truth,
                                     const Bound& bound);
/// The case without its estimates.
[[nodiscard]] CaseFigures describe(const PublishedCase& published);

inline constexpr std::size_t kPublishedWindowRows = 32;

/// ", gated" where the model has a gate.
template <class M>
[[nodiscard]] constexpr const char* gated() {
  return M::kGates > 0 ? ", gated" : "";
}

/// D8 in the windows of the publication where `window_rows` differs, in four windows that are the
/// quarters of the run, and over the whole run: the same rows combined in other ways. Of two masses
/// also in windows of 32 instants, 64 rows. Last, where the model has a gate, D8 as published: all
/// rows in windows of 32.
template <class M>
[[nodiscard]] std::vector<MethodResult> other_ways(const Measured<M::kDof>& input, const M& model,
                                                   std::size_t window_rows) {
  using Rows = MotionRows<D8, M>;
  std::vector<MethodResult> out;
  if (window_rows != kPublishedWindowRows) {
    out.push_back(over_windows<Rows>(input, model, kPublishedWindowRows));
    out.back().method = fmt::format("D8, windows of {} rows{}", kPublishedWindowRows, gated<M>());
  }
  MethodResult whole = over_run<Rows>(input, model);
  const std::size_t quarter = whole.rows / 4;
  out.push_back(over_windows<Rows>(input, model, quarter));
  out.back().method = fmt::format("D8, quarters of the run ({} rows){}", quarter, gated<M>());
  whole.method = std::string{"D8, recursive over the run"} + gated<M>();
  out.push_back(whole);
  if constexpr (M::kDof > 1) {
    out.push_back(over_windows<Rows>(input, model, M::kDof * kPublishedWindowRows));
    out.back().method =
        fmt::format("D8, windows of {} instants{}", kPublishedWindowRows, gated<M>());
  }
  if constexpr (M::kGates > 0) {
    out.push_back(over_windows<Rows>(input, model, kPublishedWindowRows, Gate::kOff));
    out.back().method = fmt::format("D8, windows of {} rows, not gated", kPublishedWindowRows);
  }
  return out;
}

/// The case by D8 in windows (the publication's way), by D12 in windows, and by D16 over the run,
/// with bounds; then by other_ways() without.
template <class M>
[[nodiscard]] CaseFigures recompute(const PublishedCase& published, const M& model,
                                    const Promise& promise,
                                    std::size_t window_rows = kPublishedWindowRows) {
  const auto input = measured<M::kDof>(published.simulate(), published.chain.mass_kg);
  MethodResult d8 = over_windows<MotionRows<D8, M>>(input, model, window_rows);
  MethodResult d12 = over_windows<MotionRows<D12, M>>(input, model, window_rows);
  MethodResult d16 = over_run<MotionRows<D16, M>>(input, model);
  d8.method = fmt::format("D8, windows of {} rows{}", window_rows, gated<M>());
  d12.method = fmt::format("D12, windows of {} rows{}", window_rows, gated<M>());
  d16.method = std::string{"D16, recursive over the run"} + gated<M>();
  const std::vector<MethodResult> others = other_ways(input, model, window_rows);
  CaseFigures out = describe(published);
  for (std::size_t i = 0; i < published.parameters.size(); ++i) {
    const PublishedParameter& parameter = published.parameters[i];
    const Bound d16_bound{.error = parameter.faint ? promise.faint_d16_error : promise.d16_error};
    const Bound& d8_bound = parameter.faint ? promise.faint_d8 : promise.d8;
    std::vector<Estimate>& estimates = out.parameters[i].estimates;
    estimates = {make_estimate(d8, i, parameter.truth, d8_bound),
                 make_estimate(d12, i, parameter.truth, promise.d12_for(parameter)),
                 make_estimate(d16, i, parameter.truth, d16_bound)};
    for (const MethodResult& other : others)
      estimates.push_back(make_estimate(other, i, parameter.truth, {}));
  }
  return out;
}

}  // namespace dampline::app
