// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <string>

#include "app/explain/evidence_point.hpp"

namespace dampline::app {

/// What is left of the force after everything that was found: what it looks like and where it is.
/// Shares are of the residual's energy, each from a map that was filled on the other half of the
/// record, so that noise gives none.
struct Signature {
  double rms_n{0.0};
  double surface_share{0.0};  ///< a function of y and v explains it
  double odd_share{0.0};      ///< of that surface's energy, under (y, v) -> (-y, -v); else even
  double travel_share{0.0};   ///< a function of direction and travel since the reversal explains it
  double low_hz{0.0};         ///< a tenth of the energy lies below
  double peak_hz{0.0};
  double high_hz{0.0};       ///< a tenth of the energy lies above
  double worst_time_s{0.0};  ///< where in the record most of it is
  double worst_share{0.0};   ///< that stretch's energy over the median stretch's
  std::array<double, kEvidenceChannels> coherence{};  ///< with each channel, by energy

  /// A function of the instant rather than of what was before.
  [[nodiscard]] bool memoryless() const noexcept {
    return surface_share > kClear && surface_share >= travel_share;
  }
  [[nodiscard]] bool has_memory() const noexcept {
    return travel_share > kClear && travel_share > surface_share;
  }
  static constexpr double kClear = 0.2;
  static constexpr double kMostly = 0.8;
};

/// "memoryless, odd; 3 to 11 Hz" and the like.
[[nodiscard]] std::string describe(const Signature& signature);

}  // namespace dampline::app
