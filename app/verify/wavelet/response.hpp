// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <vector>

#include "app/verify/wavelet/cases.hpp"

namespace dampline::app {

/// A term of an element, as a regressor and as the reference simulator's coefficient.
struct ElementTerm {
  const char* name{""};
  sim::reference::Real sim::reference::Element::*coefficient{nullptr};
  double (*value)(double x, double v){nullptr};
};

/// Names: c, k, k2, c2, k3, "x^2 x'", "x'^3", e. Throws std::invalid_argument for another.
[[nodiscard]] std::vector<ElementTerm> element_terms(const std::vector<std::string>& names);

/// Equation 35 as the publication applies it: the terms of every element from D8 in windows of 32
/// equations, the mean over the windows simulated from the same start under the same input, and the
/// accelerations of the two responses compared, per mass in per cent. The run has 512 samples, the
/// level j = 9 of the publication. Infinite where the estimated model's response grows without
/// bound.
[[nodiscard]] std::vector<double> response_mse_percent(const PublishedCase& published,
                                                       const std::vector<ElementTerm>& terms);

}  // namespace dampline::app
