// SPDX-License-Identifier: MIT
#include "app/verify/wavelet/case_results.hpp"
#include "app/verify/wavelet/models.hpp"
#include "app/verify/wavelet/recompute.hpp"

namespace dampline::app {

CaseFigures product_result() {
  return recompute(product_case(), SingleModel<ProductTerms>{}, kSmooth);
}

CaseFigures duffing_result(bool forced) {
  return recompute(duffing_case(forced), SingleModel<DuffingTerms>{}, kSmooth);
}

CaseFigures van_der_pol_result(bool forced) {
  return recompute(van_der_pol_case(forced), SingleModel<VanDerPolTerms>{}, kSmooth);
}

}  // namespace dampline::app
