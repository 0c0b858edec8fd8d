// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "dampline/snapshot.hpp"

namespace dampline::proof {

/// Every number that an identification ends in, by name.
using Figures = std::vector<std::pair<std::string, double>>;

[[nodiscard]] Figures figures_of(const Snapshot& snapshot);

/// One figure a line, name and hexadecimal floating point: exact.
[[nodiscard]] std::string write_figures(const Figures& figures);
[[nodiscard]] Figures read_figures(const std::string& text);

/// FNV-1a over names and bits.
[[nodiscard]] std::uint64_t hash_figures(const Figures& figures);

}  // namespace dampline::proof
