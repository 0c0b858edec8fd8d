// SPDX-License-Identifier: MIT
#include "app/verify/printed/printed.hpp"

// clang-format off
namespace dampline::app {

const std::vector<PrintedTable>& phase_mappings() {
  static const std::vector<PrintedTable> all{
      {"resonance", 0, "resonance frequencies, rad/s (section 4; m = 1, H1 = 1, yc = 0.5)",
       {"viscous", "Coulomb", "structural"},
       {{"omega", {"0.69", "0.12", "0.16"}}}},
      {"resonance inputs", 0, "amplitudes of P1 cos(omega t)",
       {"1", "2", "3"},
       {{"P1", {"0.1", "0.5", "1"}}}},
      {"inputs", 0, "P1 cos(omega t) + P0 of section 5b (m = 1, H1 = 1, yc = 0.5, r(y) = y)",
       {"1", "2", "3"},
       {{"omega", {"0.5", "1", "2"}},
        {"P1", {"0.1", "0.5", "1"}},
        {"P0", {"-0.1", "0.1", "1"}}}},
      {"system", 0, "of section 5b", {"m", "H1", "yc"}, {{"system", {"1", "1", "0.5"}}}}};
  return all;
}

}  // namespace dampline::app
// clang-format on
