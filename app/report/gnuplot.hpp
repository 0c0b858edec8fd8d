// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

namespace dampline::app {

/// gnuplot scripts with their data, to which the terminal is still to be set. Empty where the
/// result has nothing to draw.
struct PlotScript {
  std::string script;
  int width{960};
  int height{420};
};

struct ChildResult {
  bool started{false};  ///< false: there is no such program
  int status{-1};       ///< exit code; 128 + signal when killed
  std::string output;
  std::string error;
};

/// Runs a program found in PATH with `input` on its standard input and waits for its end. No shell.
/// Throws RunError when the system cannot (no temporary file, no process).
[[nodiscard]] ChildResult run_child(const std::vector<std::string>& command,
                                    const std::string& input);

/// An <svg> element to stand inside a page, or the reason why there is none.
struct Drawing {
  std::string svg;
  std::string problem;
};

/// Runs gnuplot as a child process. `name` keeps the identifiers of several drawings on one page
/// apart.
[[nodiscard]] Drawing draw(const PlotScript& plot, const std::string& name);

/// Two colours that everybody can tell apart.
inline constexpr std::string_view kPlotBlue = "#0b5fa5";
inline constexpr std::string_view kPlotOrange = "#d55e00";

/// What every plot starts with: axes, grid, margins, key.
inline constexpr std::string_view kPlotFrame =
    "set border 3 lc rgb '#555555'\nset tics nomirror out scale 0.6 tc rgb '#333333'\n"
    "set grid back lc rgb '#dddddd' lt 1 lw 0.6\nset lmargin at screen 0.105\n"
    "set rmargin at screen 0.975\nset key top left Left reverse samplen 2 spacing 1.1 opaque "
    "fillcolor '#ffffff'\n"
    "set style fill transparent solid 0.22 noborder\nset encoding utf8\n";

/// A number's unit as a plot shows it, and the factor to it: kN and MN/m where N and N/m would need
/// many digits.
struct PlotUnit {
  double factor{1.0};
  std::string name;
};
[[nodiscard]] inline PlotUnit plot_unit(const std::string& unit, double largest) {
  constexpr double kLargeN = 2e3;
  constexpr double kLargeNpm = 1e5;
  if (unit == "N" && largest >= kLargeN) return {1e-3, "kN"};
  if (unit == "N/m" && largest >= kLargeNpm) return {1e-6, "MN/m"};
  return {1.0, unit};
}

/// For the largest force of `rows`.
template <class Row>
[[nodiscard]] PlotUnit force_unit(const std::vector<Row>& rows, double Row::*force) {
  double largest = 0.0;
  for (const Row& row : rows) largest = std::max(largest, std::fabs(row.*force));
  return plot_unit("N", largest);
}

/// Every so many of `count` points of one line are drawn; more are not seen.
[[nodiscard]] inline std::size_t plot_stride(std::size_t count) {
  constexpr std::size_t kMostPoints = 3000;
  return std::max<std::size_t>(1, (count + kMostPoints - 1) / kMostPoints);
}

/// A name with blanks: gnuplot would lower what follows a low line.
[[nodiscard]] inline std::string plot_label(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

/// The key above the panel, where it hides nothing.
inline constexpr std::string_view kPlotKeyAbove =
    "set key at graph 1,graph 1.02 right bottom horizontal maxrows 1 samplen 2 noopaque\n";

}  // namespace dampline::app
