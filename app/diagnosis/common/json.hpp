// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/diagnosis/common/residual.hpp"

namespace dampline::app {

/// An effect that was tried and not chosen.
struct JudgedCandidate {
  std::string effect;
  double held_out_nmse{0.0};
  double gain{0.0};     ///< share of the held-out error that it takes away
  double block_t{0.0};  ///< mean over deviation of the mean of the blocks' improvements
};

/// What is left, as explanation.json tells it. `unknown`: it is real and has no name.
[[nodiscard]] nlohmann::ordered_json signature_json(
    const Signature& signature, const std::array<const char*, kEvidenceChannels>& channels,
    bool unknown);

/// The step of a residual that is real and that nothing explains: it changes nothing.
[[nodiscard]] nlohmann::ordered_json unknown_step(const std::vector<std::string>& terms,
                                                  double held_out_nmse, const Signature& signature);

/// Effects that were tried and not chosen.
[[nodiscard]] nlohmann::ordered_json judged_json(const std::vector<JudgedCandidate>& candidates);

}  // namespace dampline::app
