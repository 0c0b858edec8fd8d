// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "dampline/effect/conclusion.hpp"

namespace dampline::test {

/// Errors in units of what was stated.
struct Coverage {
  std::size_t records{0};
  std::size_t within{0};  ///< two deviations
  double sum{0.0};
  double squares{0.0};
  double share{0.0};  ///< sum of errors over the truth

  void add(const Estimate& found, double truth) {
    const double z = (found.value - truth) / found.std;
    ++records;
    if (std::abs(z) <= 2.0) ++within;
    sum += z;
    squares += z * z;
    share += found.value / truth - 1.0;
  }
  [[nodiscard]] double within_share() const {
    return static_cast<double>(within) / static_cast<double>(records);
  }
  [[nodiscard]] double mean() const { return sum / static_cast<double>(records); }
  [[nodiscard]] double rms() const { return std::sqrt(squares / static_cast<double>(records)); }
  [[nodiscard]] double mean_error() const { return share / static_cast<double>(records); }
};

/// True values of what an explanation prints, by name; those of friction and spring first.
using Truths = std::vector<std::pair<std::string, double>>;

/// Each parameter of an explanation whose truth is known.
template <class Take>
void compare(const effect::Explanation& e, const Truths& truths, const Take& take) {
  for (const auto& [name, truth] : truths) {
    if (name == "coulomb") take(name, e.final_coulomb_n, truth);
    if (name == "stiffness") take(name, e.final_stiffness_npm, truth);
    for (std::size_t s = 0; s < e.step_count; ++s)
      for (std::size_t p = 0; p < e.step[s].parameter_count; ++p)
        if (name == e.step[s].parameter[p].name) take(name, e.step[s].parameter[p].estimate, truth);
  }
}

}  // namespace dampline::test
