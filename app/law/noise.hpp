// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "app/law/shooting.hpp"

namespace dampline::app::law {

/// White noise of a record, rms.
struct Noise {
  double force_n{0.0};
  double deflection_m{0.0};
};

/// Rms of the white noise in a signal: no more than it has where its spectrum is quietest.
[[nodiscard]] double white_rms(const Eigen::VectorXd& values);

/// What the law leaves of records that it would itself have made, with so much noise: its motion
/// under the measured force and the noise that the mass feels, not the law, is followed as `shot`
/// was, from segment to segment. `noise`: of each drive. Not ok where the law runs away.
[[nodiscard]] Shot follow_own_noise(const LawOf& law_of, const Shot& shot,
                                    const std::vector<Drive>& drives,
                                    const std::vector<Noise>& noise, std::uint64_t seed);

}  // namespace dampline::app::law
