// SPDX-License-Identifier: MIT
#pragma once
#include <string>

namespace dampline::generate {

/// The text of firmware_core/published/wavelet/daubechies.hpp.
[[nodiscard]] std::string connection_header();

}  // namespace dampline::generate
