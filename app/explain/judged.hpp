// SPDX-License-Identifier: MIT
#pragma once
#include <string>

namespace dampline::app {

/// An effect that was tried and not chosen.
struct JudgedCandidate {
  std::string effect;
  double held_out_nmse{0.0};
  double gain{0.0};     ///< share of the held-out error that it takes away
  double block_t{0.0};  ///< mean over deviation of the mean of the blocks' improvements
};

}  // namespace dampline::app
