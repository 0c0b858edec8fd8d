// SPDX-License-Identifier: MIT
#include "app/verify/wavelet/case_results.hpp"
#include "app/verify/wavelet/models.hpp"
#include "app/verify/wavelet/recompute.hpp"

namespace dampline::app {

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

}  // namespace dampline::app
