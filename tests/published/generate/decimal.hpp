// SPDX-License-Identifier: MIT
#pragma once
#include <gmpxx.h>

#include <string>

namespace dampline::generate {

/// Correct to 25 digits, so that the compiler rounds it as it would round the exact number.
[[nodiscard]] std::string decimal(const mpf_class& x);

}  // namespace dampline::generate
