// SPDX-License-Identifier: MIT
#include "app/verify/wavelet/figures.hpp"

#include <cmath>

namespace dampline::app {
namespace {

void count(bool bound, bool met, Tally& out) {
  if (!bound && met) return;
  ++out.bound;
  if (met) ++out.met;
}

}  // namespace

Tally tally(const WaveletFigures& figures) {
  Tally out;
  for (const CaseFigures& one : figures.cases) {
    for (const ParameterFigures& parameter : one.parameters) {
      for (const Estimate& estimate : parameter.estimates) {
        count(std::isfinite(estimate.bound.error) || std::isfinite(estimate.bound.spread),
              estimate.met(), out);
      }
    }
  }
  for (const CheckGroup& group : figures.groups) {
    for (const Check& check : group.checks)
      count(check.at_most || check.at_least, check.met(), out);
  }
  return out;
}

}  // namespace dampline::app
