// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

#include "dampline/can_frame.hpp"
#include "dampline/damping/estimator.hpp"

namespace dampline::proof {

/// One instant of a ride as every room takes it; a file of these is what room_probe reads.
struct Instant {
  std::array<CanFrame, kChannels> frames{};
  Sample sample{};
  UpdateResult result{};  ///< of an Estimator that has seen all samples up to this one
};

/// Resolution of the accelerations in `frames`, m/s^2 per count: 12 bit over 5 g and 10 g.
inline constexpr std::array<double, kChannels> kCountMps2{49.03325 / 2048.0, 98.0665 / 2048.0,
                                                          98.0665 / 2048.0};

inline constexpr std::array kRoomNames{"decode", "screen",   "motion",  "density",
                                       "phase",  "guard",    "effect",  "identifier",
                                       "chain",  "identify", "explain", "answer"};

}  // namespace dampline::proof
