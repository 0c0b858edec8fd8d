// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "app/verify/phase/pictures.hpp"

namespace dampline::app {

/// One figure beside the published one.
struct PhaseRow {
  std::string table;
  std::string what;
  std::string unit{};
  std::optional<double> published{};
  std::optional<double> found{};      ///< absent: there is none, and `remark` says why
  std::optional<double> deviation{};  ///< standard deviation of `found`, or over the runs
  std::optional<double> at_least{};
  std::optional<double> at_most{};
  std::string remark{};

  /// Figures without a bound are told, not judged.
  [[nodiscard]] bool met() const {
    if (!at_least && !at_most) return true;
    return found && (!at_least || *found >= *at_least) && (!at_most || *found <= *at_most);
  }
};

[[nodiscard]] std::vector<PhaseRow> resonance_rows();
/// `runs`: seeds; the time that this takes grows with it.
[[nodiscard]] std::vector<PhaseRow> planarity_rows(int runs);
[[nodiscard]] std::vector<PhaseRow> linearity_rows(int runs);
[[nodiscard]] std::vector<PhaseRow> friction_rows(int runs);
/// g(y) at the publication's own inputs: a curve per frequency, amplitude and mean, as its figures.
[[nodiscard]] std::vector<PhaseRow> figure_rows(const std::vector<FrictionFamily>& families);

[[nodiscard]] std::string text_of(const std::vector<PhaseRow>& rows);
[[nodiscard]] std::string markdown_of(const std::vector<PhaseRow>& rows);
[[nodiscard]] std::string json_of(const std::vector<PhaseRow>& rows);

}  // namespace dampline::app
