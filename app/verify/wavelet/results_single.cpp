// SPDX-License-Identifier: MIT
#include <array>

#include "app/verify/wavelet/case_results.hpp"
#include "app/verify/wavelet/models.hpp"
#include "app/verify/wavelet/recompute.hpp"
#include "published/wavelet/product_rows.hpp"

namespace dampline::app {

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
  constexpr std::array<double, 3> kPublishedCov{1.8e-3, 1.6e-4, 2.9e-2};
  for (std::size_t i = 0; i < published.parameters.size(); ++i)
    published.parameters[i].spread = kPublishedCov[i];
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

CaseFigures duffing_result(bool forced) {
  return recompute(duffing_case(forced), SingleModel<DuffingTerms>{}, kSmooth);
}

CaseFigures van_der_pol_result(bool forced) {
  return recompute(van_der_pol_case(forced), SingleModel<VanDerPolTerms>{}, kSmooth);
}

}  // namespace dampline::app
