// SPDX-License-Identifier: MIT
#include "app/verify/wavelet/recompute.hpp"

#include <cmath>

namespace dampline::app {

Estimate make_estimate(const MethodResult& result, std::size_t unknown, double truth,
                       const Bound& bound) {
  const double value = result.value[unknown];
  const double std = result.std[unknown];
  const bool relative = truth != 0.0;
  return {.method = result.method,
          .value = value,
          .error = relative ? (value - truth) / truth : value,
          .spread = relative ? std / std::abs(value) : std,
          .rows = result.rows,
          .windows = result.windows,
          .bound = bound};
}

CaseFigures describe(const PublishedCase& published) {
  CaseFigures out{.tables = published.tables,
                  .title = published.title,
                  .conditions = published.conditions,
                  .notes = published.notes,
                  .step_s = published.resolution.step_s,
                  .samples = published.resolution.samples,
                  .parameters = {}};
  for (const PublishedParameter& one : published.parameters) {
    out.parameters.push_back({.name = one.name,
                              .unit = one.unit,
                              .truth = one.truth,
                              .published_value = one.value,
                              .published_spread = one.spread,
                              .estimates = {}});
  }
  return out;
}

}  // namespace dampline::app
