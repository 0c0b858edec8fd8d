// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/verify/printed/printed.hpp"
#include "app/verify/reference/chain.hpp"

namespace dampline::app {

/// A parameter as published: estimate and coefficient of variation where the publication has them
/// (the standard deviation where the truth is 0).
struct PublishedParameter {
  const char* name{""};
  const char* unit{""};
  double truth{0.0};
  bool faint{false};  ///< hardly excited: cubic terms of tables 8 to 10
  std::optional<Printed> value{};
  std::optional<Printed> spread{};
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

/// How tables 3 and 4 are driven. Equations 21 to 23 give the phase (0.5 + t / Tf) t, whose rate
/// rises from 0.5 to 2.5 rad/s; with half of that slope the rate itself rises from 0.5 to 1.5.
enum class Drive : std::uint8_t { kFree, kEquations, kHalfSlope };

// One degree of freedom, smooth.
[[nodiscard]] PublishedCase product_case();
[[nodiscard]] PublishedCase duffing_case(Drive drive);
[[nodiscard]] PublishedCase van_der_pol_case(Drive drive);
/// Both non-linear terms at once, table 17 only, under the input and the step of either.
enum class InputOf : std::uint8_t { kDuffing, kVanDerPol };
[[nodiscard]] PublishedCase duffing_van_der_pol_case(InputOf input, Drive drive);
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
[[nodiscard]] PublishedCase linear_coulomb_case(double ratio, double slope_npm,
                                                sim::reference::Signum signum);
/// The elements of table 7 with Coulomb friction in both, for the row of table 18 whose system is
/// not published.
[[nodiscard]] PublishedCase coulomb_elements_case();
[[nodiscard]] PublishedCase teflon_case();

}  // namespace dampline::app
