// SPDX-License-Identifier: MIT
#pragma once
#include <set>
#include <string>

namespace dampline::proof {

/// What a static library needs from outside itself, as nm names it (mangled).
/// Throws std::runtime_error where nm fails.
[[nodiscard]] std::set<std::string> needed_symbols(const std::string& archive);

/// Those of them that are neither plain arithmetic, nor copying of memory, nor abort().
[[nodiscard]] std::set<std::string> forbidden_symbols(const std::string& archive);

}  // namespace dampline::proof
