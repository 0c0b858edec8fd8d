// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace dampline::proof {

/// Instructions of each call of the function named `function` while `command` runs under callgrind,
/// in the order of the calls. `folder` is emptied and holds valgrind's files afterwards.
/// Throws std::runtime_error where valgrind or the command fails.
[[nodiscard]] std::vector<std::uint64_t> instructions_per_call(const std::string& command,
                                                               const std::string& function,
                                                               const std::string& folder);

}  // namespace dampline::proof
