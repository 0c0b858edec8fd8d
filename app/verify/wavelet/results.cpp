// SPDX-License-Identifier: MIT
#include "app/verify/wavelet/results.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "app/verify/wavelet/recompute.hpp"
#include "app/verify/wavelet/rows.hpp"
#include "published/wavelet/product_rows.hpp"

namespace dampline::app {
namespace {

using sim::reference::Signum;

constexpr Promise kGated = friction_promise(1e-6, 1e-5);
constexpr Promise kLongWindows = friction_promise(1e-5, 2e-5);

/// Representations that the publication has no table for.
constexpr Promise beside_the_tables() {
  Promise out = kLongWindows;
  out.d16_error = out.d8.error;
  return out;
}

template <class Sign>
CaseFigures smooth_sign_result(Signum signum, const char* formula, const char* table,
                               const Promise& promise = beside_the_tables()) {
  PublishedCase published = coulomb_forced_case(signum);
  published.tables = {table};
  published.title = fmt::format("Coulomb friction, forced, sign v as {}", formula);
  return recompute(published, SingleModel<CoulombTerms<Sign>>{}, promise, 314);
}

/// Of the input of table 15.
std::size_t two_cycles(double ratio, double step_s) {
  const double cycle_s = 2.0 * std::numbers::pi / (5.0 * ratio);
  return static_cast<std::size_t>(std::round(2.0 * cycle_s / step_s));
}

}  // namespace

Estimate make_estimate(const MethodResult& result, std::size_t unknown, double truth,
                       const Bound& bound) {
  const double value = result.value[unknown];
  const double std = result.std[unknown];
  const bool relative = truth != 0.0;
  return {.method = result.method,
          .value = value,
          .error = relative ? (value - truth) / truth : value,
          .spread = relative ? std / std::abs(value) : std,
          .rows = result.rows,
          .windows = result.windows,
          .bound = bound};
}

CaseFigures describe(const PublishedCase& published) {
  CaseFigures out{.tables = published.tables,
                  .title = published.title,
                  .conditions = published.conditions,
                  .notes = published.notes,
                  .step_s = published.resolution.step_s,
                  .samples = published.resolution.samples,
                  .parameters = {}};
  for (const PublishedParameter& one : published.parameters) {
    out.parameters.push_back({.name = one.name,
                              .unit = one.unit,
                              .truth = one.truth,
                              .published_value = one.value,
                              .published_spread = one.spread,
                              .estimates = {}});
  }
  return out;
}

CaseFigures product_result() {
  return recompute(product_case(), SingleModel<ProductTerms>{}, kSmooth);
}

CaseFigures product_by_omega_result() {
  using Model = SingleModel<ProductTerms>;
  constexpr int kProduct = 2;  // the column of x x'
  PublishedCase published = product_case();
  published.title += ", equation 11";
  published.notes = {
      "Equation 11: x x' by the product coefficients of the wavelet, which with samples for "
      "scaling coefficients are of third order in the step."};
  for (PublishedParameter& one : published.parameters)
    one.spread = printed_table(ghanem_romeo(), "1").at(std::string{"COV "} + one.name, "Eq. (11)");
  const auto input = measured<1>(published.simulate(), published.chain.mass_kg);
  const Model model;
  MethodResult d8 = over_windows<ProductRows<Model, kProduct>>(input, model, kPublishedWindowRows);
  d8.method = "D8, equation 11, windows of 32 rows";
  CaseFigures out = describe(published);
  out.own_methods = true;
  for (std::size_t i = 0; i < published.parameters.size(); ++i) {
    const double truth = published.parameters[i].truth;
    out.parameters[i].estimates = {make_estimate(d8, i, truth, kSmooth.d8)};
  }
  return out;
}

CaseFigures duffing_result(Drive drive) {
  return recompute(duffing_case(drive), SingleModel<DuffingTerms>{},
                   drive == Drive::kEquations ? kFastSweep : kSmooth);
}

CaseFigures van_der_pol_result(Drive drive) {
  return recompute(van_der_pol_case(drive), SingleModel<VanDerPolTerms>{}, kSmooth);
}

CaseFigures duffing_chain_result(bool forced) {
  return recompute(duffing_chain_case(forced), ChainModel<DuffingTerms, DuffingTerms>{}, kSmooth);
}

CaseFigures van_der_pol_chain_result(bool forced) {
  return recompute(van_der_pol_chain_case(forced), ChainModel<VanDerPolTerms, VanDerPolTerms>{},
                   kSmooth);
}

CaseFigures coulomb_chain_result() {
  return recompute(coulomb_chain_case(), GroundedFrictionModel<>{}, friction_promise(1e-5, 5e-5));
}

CaseFigures coulomb_free_result() {
  return recompute(coulomb_free_case(), SingleModel<CoulombTerms<ExactSign>>{}, kGated);
}

CaseFigures coulomb_forced_result() {
  return recompute(coulomb_forced_case(Signum::kExact), SingleModel<CoulombTerms<ExactSign>>{},
                   kGated);
}

CaseFigures coulomb_tanh_result() {
  return smooth_sign_result<TanhSign>(Signum::kTanh, "tanh(1500 v)", "13", kLongWindows);
}
CaseFigures coulomb_erf_result() {
  return smooth_sign_result<ErfSign>(Signum::kErf, "erf(1500 v)", "signs");
}
CaseFigures coulomb_arctangent_result() {
  return smooth_sign_result<AtanSign>(Signum::kArctangent, "2/pi atan(1500 v)", "signs");
}
CaseFigures coulomb_rational_result() {
  return smooth_sign_result<RationalSign>(Signum::kRational, "1500 v / (1 + 1500 |v|)", "signs");
}

CaseFigures linear_coulomb_result(double ratio, double slope_npm) {
  PublishedCase published = linear_coulomb_case(ratio, slope_npm, Signum::kExact);
  published.title = fmt::format("linear/Coulomb friction, b = {}, fk = {} N/m", ratio, slope_npm);
  return recompute(published, SingleModel<LinearCoulombTerms<ExactSign>>{}, kGated,
                   two_cycles(ratio, published.resolution.step_s));
}

CaseFigures linear_coulomb_tanh_result(double slope_npm) {
  constexpr double kRatio = 0.6;
  PublishedCase published = linear_coulomb_case(kRatio, slope_npm, Signum::kTanh);
  published.title = fmt::format(
      "linear/Coulomb friction, b = {}, fk = {} N/m, sign v as tanh(200 v)", kRatio, slope_npm);
  published.notes.emplace_back("tanh(200 v) as published for the motion with stops (page 854).");
  const TanhSign sign{.sharpness_spm = 200.0};
  const LinearCoulombTerms<TanhSign> terms{Viscous{}, Spring{}, Friction<TanhSign>{sign},
                                           ProgressiveFriction<TanhSign>{sign}};
  return recompute(published, SingleModel<LinearCoulombTerms<TanhSign>>{terms},
                   friction_promise(1e-5, 1e-5), two_cycles(kRatio, published.resolution.step_s));
}

CaseFigures teflon_result() {
  const TanhSign sign{.sharpness_spm = 1000.0};
  const TeflonTerms terms{Viscous{}, Spring{}, Friction<TanhSign>{sign},
                          ExponentialFriction<TanhSign>{.rate_spm = 23.6, .sign = sign}};
  return recompute(teflon_case(), SingleModel<TeflonTerms>{terms}, kLongWindows, 400);
}

}  // namespace dampline::app
