// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "app/verify/printed/printed.hpp"

namespace dampline::app {

/// What an estimate must not exceed; infinite: nothing is promised.
struct Bound {
  double error{std::numeric_limits<double>::infinity()};
  double spread{std::numeric_limits<double>::infinity()};
};

/// One parameter by one method. `error` is relative to the truth, and `spread` is the coefficient
/// of variation; where the truth is 0, both are absolute, in the parameter's unit. Over windows,
/// value and spread are the mean and the standard deviation of the windows' estimates; of a
/// recursive estimate, the spread is the standard deviation by its own residual.
struct Estimate {
  std::string method{};
  double value{0.0};
  double error{0.0};
  double spread{0.0};
  std::size_t rows{0};
  std::size_t windows{0};  ///< 0: recursive, over all rows
  Bound bound{};

  /// False as well where what is bound is not a number.
  [[nodiscard]] bool error_met() const noexcept {
    return !std::isfinite(bound.error) || std::abs(error) <= bound.error;
  }
  [[nodiscard]] bool spread_met() const noexcept {
    return !std::isfinite(bound.spread) || spread <= bound.spread;
  }
  [[nodiscard]] bool met() const noexcept { return error_met() && spread_met(); }
  [[nodiscard]] bool is_bound() const noexcept {
    return std::isfinite(bound.error) || std::isfinite(bound.spread);
  }
};

/// A parameter of a published case: the truth, what was published, what is found.
struct ParameterFigures {
  std::string name;
  std::string unit{};
  double truth{0.0};
  std::optional<Printed> published_value{};
  std::optional<Printed> published_spread{};
  std::vector<Estimate> estimates;
};

/// One system of one table.
struct CaseFigures {
  std::vector<std::string> tables{};
  std::string title{};
  std::string conditions;
  std::vector<std::string> notes;  ///< misprints repaired, what was assumed
  bool own_methods{false};         ///< estimates by other methods than those of recompute()
  double step_s{0.0};
  std::size_t samples{0};
  std::vector<ParameterFigures> parameters;
};

/// A figure that is no estimate, with the bound that it must keep.
struct Check {
  std::string what{};
  std::string unit{};
  std::optional<Printed> published{};
  double found{0.0};
  std::optional<double> at_most{};
  std::optional<double> at_least{};

  [[nodiscard]] bool met() const noexcept {
    return (!at_most || found <= *at_most) && (!at_least || found >= *at_least) && found == found;
  }
  [[nodiscard]] bool is_bound() const noexcept { return at_most || at_least; }
};

/// Figures that belong together, of a table or of a property of the method.
struct CheckGroup {
  std::vector<std::string> tables{};
  std::string title{};
  std::vector<std::string> notes{};
  std::vector<Check> checks{};
};

struct WaveletFigures {
  std::vector<CaseFigures> cases;
  std::vector<CheckGroup> groups;
};

/// How many figures have a bound, and how many of them keep it.
struct Tally {
  std::size_t bound{0};
  std::size_t met{0};
};
[[nodiscard]] Tally tally(const WaveletFigures& figures);
/// One line for each figure that misses its bound: where, what was found, what was promised.
[[nodiscard]] std::vector<std::string> missed(const WaveletFigures& figures);

}  // namespace dampline::app
