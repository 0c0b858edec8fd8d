// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <string_view>

namespace dampline::app {

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

/// A name with blanks: gnuplot would lower what follows a low line.
[[nodiscard]] inline std::string plot_label(std::string name) {
  for (char& c : name)
    if (c == '_') c = ' ';
  return name;
}

/// The key above the panel, where it hides nothing.
inline constexpr std::string_view kPlotKeyAbove =
    "set key at graph 1,graph 1.02 right bottom horizontal maxrows 1 samplen 2 noopaque\n";

}  // namespace dampline::app
