// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "app/verify/wavelet/figures.hpp"

namespace dampline::app {

/// Table 17: one degree of freedom, the true, the linear and a model of seven terms.
[[nodiscard]] std::vector<CheckGroup> single_selection();
/// Table 18: the chain of two masses, ten terms.
[[nodiscard]] std::vector<CheckGroup> chain_selection();

}  // namespace dampline::app
