// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "app/verify/wavelet/recompute.hpp"
#include "app/verify/wavelet/results.hpp"

namespace dampline::app {
namespace {

/// Magnitudes of the extremes, the start among them; each is the top of the parabola through the
/// sample and its neighbours.
std::vector<double> extremes_m(const std::vector<double>& x) {
  std::vector<double> out{std::abs(x.front())};
  for (std::size_t n = 1; n + 1 < x.size(); ++n) {
    const double before = x[n] - x[n - 1];
    const double after = x[n + 1] - x[n];
    if (before * after > 0.0 || before == 0.0) continue;
    const double bend = after - before;
    const double slope = 0.5 * (before + after);
    out.push_back(std::abs(x[n] - 0.5 * slope * slope / bend));
  }
  return out;
}

struct Decrement {
  double c_nspm{0.0};
  double e_n{0.0};
};

/// |X(i + 1)| = q |X(i)| - (1 + q) e / k, whose differences shrink by q = exp(-delta) each half
/// cycle: delta from `steps` of them, e from what is left, with the stiffness known (Liang and
/// Feeny 1998, the publication's reference 21).
Decrement decrement(const std::vector<double>& extremes_m, std::size_t steps, double mass_kg,
                    double k_npm) {
  const double first_m = extremes_m[0] - extremes_m[1];
  const double last_m = extremes_m[steps] - extremes_m[steps + 1];
  const double delta = std::log(first_m / last_m) / static_cast<double>(steps);
  const double q = std::exp(-delta);
  double friction_m = 0.0;
  for (std::size_t i = 0; i < steps; ++i)
    friction_m += (q * extremes_m[i] - extremes_m[i + 1]) / (1.0 + q);
  const double zeta = delta / std::hypot(std::numbers::pi, delta);
  return {2.0 * zeta * std::sqrt(k_npm * mass_kg), k_npm * friction_m / static_cast<double>(steps)};
}

}  // namespace

CaseFigures coulomb_decrement_result() {
  constexpr std::size_t kSteps = 5;
  const PrintedTable& printed = printed_table(ghanem_romeo(), "12");
  PublishedCase published = coulomb_free_case();
  published.title += ", decrement method";
  published.notes = {"m = 5 extremes as published; the stiffness is taken as known."};
  published.parameters.erase(published.parameters.begin() + 1);
  published.parameters[0].value = printed.at("Estimates", "decrement c");
  published.parameters[1].value = printed.at("Estimates", "decrement e");
  const Decrement found = decrement(extremes_m(published.simulate().deflection_m[0]), kSteps, 1.0,
                                    static_cast<double>(published.chain.links[0].element.k));
  const MethodResult result{.method = "decrements of 5 extremes",
                            .value = {found.c_nspm, found.e_n},
                            .std = {NAN, NAN},
                            .rows = kSteps};
  CaseFigures out = describe(published);
  out.own_methods = true;
  for (std::size_t i = 0; i < 2; ++i)
    out.parameters[i].estimates = {
        make_estimate(result, i, published.parameters[i].truth, {.error = 5e-3})};
  return out;
}

}  // namespace dampline::app
