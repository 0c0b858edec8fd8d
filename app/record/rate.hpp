// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "app/config/config.hpp"
#include "app/record/feed.hpp"
#include "app/record/source_kind.hpp"
#include "dampline/sample/ticks.hpp"
#include "dampline/snapshot.hpp"

namespace dampline::app {

/// The core integrates with the nominal period h0 = 1/f0; the record was sampled with h = 1/f.
/// Sums over samples times h0 instead of h make velocities f/f0 and deflections (f/f0)^2 too large,
/// so the stiffness comes out (f0/f)^2 and the viscous part f0/f of what they are. Forces that
/// depend on the sign of v alone do not change.
struct RateCorrection {
  double ratio{1.0};  ///< measured over nominal rate, f/f0

  static constexpr double kMost = 0.01;  ///< |ratio - 1| beyond which windows no longer fit

  [[nodiscard]] double velocity() const noexcept { return 1.0 / ratio; }
  [[nodiscard]] double deflection() const noexcept { return 1.0 / (ratio * ratio); }
  [[nodiscard]] double stiffness() const noexcept { return ratio * ratio; }
  [[nodiscard]] double viscous() const noexcept { return ratio; }
};

/// A snapshot in the record's own time.
[[nodiscard]] Snapshot corrected(const Snapshot& snapshot, const RateCorrection& correction);

/// Throws RunError naming both rates when they differ by more than RateCorrection::kMost. A rate
/// that could not be measured (too few samples) leaves everything as it is.
[[nodiscard]] RateCorrection make_correction(const MeasuredRate& measured, double nominal_hz,
                                             const std::string& source);

/// `config` with the rate that a truck's CSV file has by its own time, where none was set. Throws
/// RunError for a file that cannot be read.
[[nodiscard]] Config with_record_rate(Config config, const SourceOptions& source, SourceKind kind);

/// The identification's rate: the record's, or a whole part of it (decimation()).
[[nodiscard]] double truck_rate_hz(const InputConfig& input);

}  // namespace dampline::app
