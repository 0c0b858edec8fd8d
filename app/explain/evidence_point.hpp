// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

#include "app/run/result.hpp"

namespace dampline::app {

/// Signals beside the force with which a residual may be coherent.
inline constexpr std::size_t kEvidenceChannels = 3;

/// One instant of a record that was explained.
struct EvidencePoint : LoopRow {
  std::array<double, kEvidenceChannels> channel{};

  [[nodiscard]] double before_n() const noexcept { return measured_n - base_n; }
  [[nodiscard]] double after_n() const noexcept { return measured_n - final_n; }
};

}  // namespace dampline::app
