// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <vector>

/// What the three publications print, and nothing else: every digit as it stands in its table, with
/// the page, to be held beside the paper. Whatever `verify` shows as published comes from here.
namespace dampline::app {

/// A figure as it is printed.
struct Printed {
  std::string text;   ///< "14 900", "2.46E-2"
  double value{0.0};  ///< the number that it means

  Printed() = default;
  /// Throws std::invalid_argument for a text that is no number.
  explicit Printed(std::string as_printed);
  /// Where the print contradicts its own table: the number that it has to be.
  Printed(std::string as_printed, double read_as) : text{std::move(as_printed)}, value{read_as} {}
};

struct PrintedRow {
  std::string name;
  std::vector<std::string> figures;  ///< "-" where the table has none
};

struct PrintedTable {
  std::string name;  ///< "17", or the sentence that holds the figures
  int page{0};       ///< 0: the scanned pages have no number
  std::string caption;
  std::vector<std::string> columns;
  std::vector<PrintedRow> rows;

  [[nodiscard]] const std::string& text(const std::string& row, const std::string& column) const;
  /// Throws std::invalid_argument for a row or column that is not there, or a "-".
  [[nodiscard]] Printed at(const std::string& row, const std::string& column) const {
    return Printed{text(row, column)};
  }
};

/// Ghanem and Romeo, "A wavelet-based approach for model and parameter identification of non-linear
/// systems", International Journal of Non-Linear Mechanics 36 (2001) 835-859.
[[nodiscard]] const std::vector<PrintedTable>& ghanem_romeo();
/// Kisilowski and Urbanski, "Identification of flexible characteristics of a mechanical system
/// based on 'passive' experimentation", Mechanical Systems and Signal Processing 1 (1987) 377-387.
[[nodiscard]] const std::vector<PrintedTable>& kisilowski_urbanski();
/// "Phase trajectories mappings in dissipative system identification".
[[nodiscard]] const std::vector<PrintedTable>& phase_mappings();

/// Throws std::invalid_argument where there is none of that name.
[[nodiscard]] const PrintedTable& printed_table(const std::vector<PrintedTable>& paper,
                                                const std::string& name);

}  // namespace dampline::app
