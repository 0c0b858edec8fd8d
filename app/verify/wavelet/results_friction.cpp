// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "app/verify/wavelet/case_results.hpp"
#include "app/verify/wavelet/models.hpp"
#include "app/verify/wavelet/recompute.hpp"

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

}  // namespace

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
  PublishedCase published = linear_coulomb_case(ratio, slope_npm);
  published.title = fmt::format("linear/Coulomb friction, b = {}, fk = {} N/m", ratio, slope_npm);
  const double cycle_s = 2.0 * std::numbers::pi / (5.0 * ratio);
  const double rows = std::round(2.0 * cycle_s / published.resolution.step_s);
  return recompute(published, SingleModel<LinearCoulombTerms>{}, kGated,
                   static_cast<std::size_t>(rows));
}

CaseFigures teflon_result() {
  const TeflonTerms terms{Viscous{}, Spring{}, Friction<TanhSign>{},
                          ExponentialFriction<TanhSign>{.rate_spm = 23.6, .sign = {}}};
  return recompute(teflon_case(), SingleModel<TeflonTerms>{terms}, kLongWindows, 400);
}

}  // namespace dampline::app
