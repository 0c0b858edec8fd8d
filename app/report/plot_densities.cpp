// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "app/report/plot_style.hpp"
#include "app/report/plots.hpp"

namespace dampline::app {
namespace {

struct Moments {
  double mean{0.0};
  double std{0.0};
};

Moments moments_of(const DensityTable& table) {
  double sum = 0.0;
  double first = 0.0;
  double second = 0.0;
  for (const DensityRow& r : table.rows) {
    sum += r.density;
    first += r.density * r.centre;
    second += r.density * r.centre * r.centre;
  }
  if (!(sum > 0.0)) return {};
  const double mean = first / sum;
  return {mean, std::sqrt(std::max(0.0, second / sum - mean * mean))};
}

/// In mm and mm/s. Columns: centre, density, normal density.
std::string density_data(const DensityTable& table, std::size_t number) {
  const Moments m = moments_of(table);
  std::string data = fmt::format("$density{} << EOD\n", number);
  for (const DensityRow& r : table.rows) {
    const double z = m.std > 0.0 ? (r.centre - m.mean) / m.std : 0.0;
    const double normal =
        m.std > 0.0 ? std::exp(-0.5 * z * z) / (m.std * std::sqrt(2.0 * std::numbers::pi)) : 0.0;
    data += fmt::format("{} {} {}\n", 1e3 * r.centre, 1e-3 * r.density, 1e-3 * normal);
  }
  return data + "EOD\n";
}

bool is_velocity(const DensityTable& table) { return table.quantity == "velocity_mps"; }

}  // namespace

PlotScript plot_densities(const RunResult& result) {
  if (result.densities.empty()) return {};
  std::string script = fmt::format("{}unset key\n", kPlotFrame);
  for (std::size_t i = 0; i < result.densities.size(); ++i)
    script += density_data(result.densities[i], i);
  script += fmt::format("set multiplot layout 1,{}\nset yrange [0:*]\n", result.densities.size());
  for (std::size_t i = 0; i < result.densities.size(); ++i) {
    const bool velocity = is_velocity(result.densities[i]);
    const double left = 0.09 + 0.5 * static_cast<double>(i);
    script += fmt::format(
        "set lmargin at screen {:.2f}\nset rmargin at screen {:.2f}\n"
        "set xlabel '{}'\nset ylabel 'density ({})'\n"
        "plot $density{} using 1:2 with boxes fs solid 0.45 noborder lc rgb '{}', "
        "'' using 1:3 with lines lw 1.2 lc rgb '#555555'\n",
        left, left + 0.39, velocity ? "relative velocity v (mm/s)" : "relative deflection y (mm)",
        velocity ? "s/mm" : "1/mm", i, velocity ? kPlotOrange : kPlotBlue);
  }
  return {script + "unset multiplot\n", 960, 380};
}

}  // namespace dampline::app
