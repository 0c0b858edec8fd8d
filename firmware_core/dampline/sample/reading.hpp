// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

namespace dampline {

/// One channel's value in one frame.
struct Reading {
  std::int64_t tick{0};
  std::int64_t time_ns{0};
  double accel_mps2{0.0};
  bool saturated{false};
};

}  // namespace dampline
