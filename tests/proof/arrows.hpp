// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <vector>

#include "tests/proof/source_tree.hpp"

namespace dampline::proof {

/// The #include lines that point the wrong way, as "file includes name". Arrows run
/// app -> {drivers, sim_hw} -> hal -> core; the core knows Eigen and a few headers of std, and its
/// rooms form no circle.
[[nodiscard]] std::vector<std::string> wrong_arrows(const std::vector<SourceFile>& files);

}  // namespace dampline::proof
