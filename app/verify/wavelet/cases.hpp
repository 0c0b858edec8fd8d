// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "app/verify/reference/chain.hpp"

namespace dampline::app {

/// A parameter as published: estimate and coefficient of variation where the publication has them
/// (the standard deviation where the truth is 0).
struct PublishedParameter {
  const char* name{""};
  const char* unit{""};
  double truth{0.0};
  std::optional<double> value{};
  std::optional<double> spread{};
  bool faint{false};  ///< hardly excited: the cubic terms of table 10
};

/// A case of Ghanem and Romeo, "A wavelet-based approach for model and parameter identification of
/// non-linear systems", International Journal of Non-Linear Mechanics 36 (2001) 835-859: the system
/// and its input as data, and what the tables say. Parameters in the order of the model's unknowns.
struct PublishedCase {
  std::vector<std::string> tables{};
  std::string title{};
  std::string conditions;
  std::vector<std::string> notes{};
  sim::reference::Chain chain;
  sim::reference::Start start;
  sim::reference::Resolution resolution;
  std::vector<PublishedParameter> parameters;

  [[nodiscard]] sim::reference::Trajectory simulate() const {
    return sim::reference::simulate(chain, start, resolution);
  }
};

// One degree of freedom, smooth.
[[nodiscard]] PublishedCase product_case();
[[nodiscard]] PublishedCase duffing_case(bool forced);
[[nodiscard]] PublishedCase van_der_pol_case(bool forced);
/// Both non-linear terms at once, table 17 only.
[[nodiscard]] PublishedCase duffing_van_der_pol_case();
// Two degrees of freedom, smooth.
[[nodiscard]] PublishedCase duffing_chain_case(bool forced);
[[nodiscard]] PublishedCase van_der_pol_chain_case(bool forced);
/// Both non-linear terms in both elements, table 18 only.
[[nodiscard]] PublishedCase duffing_van_der_pol_chain_case();
// Friction.
[[nodiscard]] PublishedCase coulomb_free_case();
[[nodiscard]] PublishedCase coulomb_forced_case(sim::reference::Signum signum);
/// Driven so fast that it does not stick, table 17 only.
[[nodiscard]] PublishedCase coulomb_driven_case();
[[nodiscard]] PublishedCase coulomb_chain_case();
/// `ratio`: of the input's frequency to the natural one; `slope_npm`: fk.
[[nodiscard]] PublishedCase linear_coulomb_case(double ratio, double slope_npm);
[[nodiscard]] PublishedCase teflon_case();

}  // namespace dampline::app
