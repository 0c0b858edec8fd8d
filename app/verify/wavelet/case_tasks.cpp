// SPDX-License-Identifier: MIT
#include "app/verify/wavelet/case_results.hpp"
#include "app/verify/wavelet/properties.hpp"
#include "app/verify/wavelet/tasks.hpp"

namespace dampline::app {

const std::vector<CaseTask>& case_tasks() {
  static const std::vector<CaseTask> all{
      {{"1"}, product_result},
      {{"1"}, product_by_omega_result},
      {{"3"}, [] { return duffing_result(true); }},
      {{"3", "4"}, [] { return van_der_pol_result(true); }},
      {{"5"}, [] { return duffing_result(false); }},
      {{"5", "6"}, [] { return van_der_pol_result(false); }},
      {{"8"}, [] { return duffing_chain_result(true); }},
      {{"9"}, [] { return van_der_pol_chain_result(true); }},
      {{"10"}, [] { return duffing_chain_result(false); }},
      {{"11"}, [] { return van_der_pol_chain_result(false); }},
      {{"12"}, coulomb_free_result},
      {{"13"}, coulomb_forced_result},
      {{"13"}, coulomb_tanh_result},
      {{"14"}, coulomb_chain_result},
      {{"15"}, [] { return linear_coulomb_result(1.2, 5); }},
      {{"15"}, [] { return linear_coulomb_result(1.2, 10); }},
      {{"15"}, [] { return linear_coulomb_result(0.6, 5); }},
      {{"15"}, [] { return linear_coulomb_result(0.6, 10); }},
      {{"16"}, teflon_result},
      {{"signs"}, coulomb_erf_result},
      {{"signs"}, coulomb_arctangent_result},
      {{"signs"}, coulomb_rational_result},
      {{"noise"}, quantised_duffing_result},
  };
  return all;
}

}  // namespace dampline::app
