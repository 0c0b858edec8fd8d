// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>

#include "app/config/config.hpp"
#include "app/record/feed.hpp"
#include "app/record/source_kind.hpp"
#include "app/run/result.hpp"

namespace dampline::app {

/// What the motion of a record is, beside its rows.
struct MotionSummary {
  std::uint64_t rows{0};
  std::uint64_t gaps{0};          ///< jumps between rows: the filters start anew behind each
  double sample_rate_hz{0.0};     ///< of the rows
  double low_hz{0.0};             ///< below it velocity and deflection are drift, and taken off
  double deflection_low_hz{0.0};  ///< the same of the deflection
  double high_hz{0.0};            ///< up to here the integrators are within 0.4 %
  double latency_s{0.0};    ///< from a sample to its motion, in a live run with these settings
  double judgement_s{0.0};  ///< of it: the wait for the guards
  double noise_mps2{0.0};   ///< white noise of one sensor, rms: an upper bound, measured
  double velocity_noise_mps{0.0};  ///< what it makes of the velocity, rms
  double deflection_noise_m{0.0};  ///< and of the deflection
};

/// Deflection and velocity of a whole truck record, as the identification sees them. They wait in a
/// file of the system's temporary folder, since the record's own rate is known at its end.
class MotionSeries {
 public:
  /// Reads the whole record. Throws RunError naming source, what was found and expected, and
  /// UsageError for a setting that a truck cannot use.
  MotionSeries(const Config& config, const SourceOptions& source, SourceKind kind,
               bool show_progress);
  [[nodiscard]] const MotionSummary& summary() const noexcept { return summary_; }
  /// Every row in the order of time, in the record's own time. Throws RunError.
  void each(const std::function<void(const MotionRow&)>& row);

 private:
  struct Closer {
    void operator()(std::FILE* file) const noexcept {
      std::fclose(file);  // NOLINT(*-owning-memory): the pointer's deleter
    }
  };
  std::unique_ptr<std::FILE, Closer> file_;
  MotionSummary summary_;
  double tick_s_{0.0};
  double deflection_factor_{1.0};
  double velocity_factor_{1.0};
  std::int64_t first_tick_{0};
};

/// Noise of velocity (m/s) and deflection (m), rms, that white noise of each of the three sensors
/// makes behind the drift filters with these corners.
struct MotionNoise {
  double velocity_mps{0.0};
  double deflection_m{0.0};
};
[[nodiscard]] MotionNoise motion_noise(double noise_mps2, double rate_hz, double velocity_low_hz,
                                       double deflection_low_hz);

}  // namespace dampline::app
