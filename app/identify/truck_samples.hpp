// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

#include "app/config/config.hpp"
#include "app/record/feed.hpp"
#include "app/record/source_kind.hpp"

namespace dampline::app {

/// A truck's accelerations as the core has them: one rate, gaps and what is spoilt left out.
struct TruckSamples {
  static constexpr double kShortestS = 10.0;  ///< of a stretch
  /// Rails move wheelsets far faster than a truck swings, which turns within a sample, and more
  /// than once: times as many steps of its law as its own motion asks for (law::FreeRun).
  static constexpr int kRefinement = 4;

  /// Without a gap: from, and one past the last.
  struct Stretch {
    Eigen::Index from;
    Eigen::Index to;
  };

  std::vector<std::int64_t> tick;
  std::vector<double> frame_mps2;
  std::vector<double> wheelsets_mps2;  ///< z_1'' + z_2''
  double rate_hz{0.0};                 ///< as measured

  [[nodiscard]] std::vector<Stretch> stretches() const;
};

/// The first `most_s` of a record. Throws RunError where it holds hardly a sample, UsageError.
[[nodiscard]] TruckSamples read_truck_samples(
    const Config& config, const SourceOptions& source, SourceKind kind,
    double most_s = std::numeric_limits<double>::infinity());

}  // namespace dampline::app
