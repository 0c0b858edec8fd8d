// SPDX-License-Identifier: MIT
#include "app/verify/wavelet/figures.hpp"

#include <fmt/format.h>

namespace dampline::app {
namespace {

/// Calls `use(figures, parameter, estimate)` and `use(group, check)` for everything that is bound.
template <class UseEstimate, class UseCheck>
void for_each_bound(const WaveletFigures& figures, const UseEstimate& use_estimate,
                    const UseCheck& use_check) {
  for (const CaseFigures& one : figures.cases) {
    for (const ParameterFigures& parameter : one.parameters) {
      for (const Estimate& estimate : parameter.estimates) {
        if (estimate.is_bound()) use_estimate(one, parameter, estimate);
      }
    }
  }
  for (const CheckGroup& group : figures.groups) {
    for (const Check& check : group.checks) {
      if (check.is_bound()) use_check(group, check);
    }
  }
}

std::string excess(const char* what, double found, double bound) {
  return fmt::format(", {} {:.1e} above {:.1e}", what, found, bound);
}

}  // namespace

Tally tally(const WaveletFigures& figures) {
  Tally out;
  const auto count = [&out](bool met) {
    ++out.bound;
    if (met) ++out.met;
  };
  for_each_bound(
      figures,
      [&](const CaseFigures&, const ParameterFigures&, const Estimate& one) { count(one.met()); },
      [&](const CheckGroup&, const Check& one) { count(one.met()); });
  return out;
}

std::vector<std::string> missed(const WaveletFigures& figures) {
  std::vector<std::string> out;
  for_each_bound(
      figures,
      [&](const CaseFigures& one, const ParameterFigures& parameter, const Estimate& estimate) {
        if (estimate.met()) return;
        std::string line = fmt::format("{}, {}: {} by {}", one.tables.front(), one.title,
                                       parameter.name, estimate.method);
        if (!estimate.error_met())
          line += excess("error", std::abs(estimate.error), estimate.bound.error);
        if (!estimate.spread_met()) line += excess("COV", estimate.spread, estimate.bound.spread);
        if (estimate.windows == 1) line += ", one window only";
        out.push_back(line);
      },
      [&](const CheckGroup& group, const Check& check) {
        if (check.met()) return;
        std::string line = fmt::format("{}, {}: {} is {:.4g}", group.tables.front(), group.title,
                                       check.what, check.found);
        if (check.at_least) line += fmt::format(", promised at least {:.4g}", *check.at_least);
        if (check.at_most) line += fmt::format(", promised at most {:.4g}", *check.at_most);
        out.push_back(line);
      });
  return out;
}

}  // namespace dampline::app
