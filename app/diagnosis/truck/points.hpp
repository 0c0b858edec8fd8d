// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "app/diagnosis/common/residual.hpp"
#include "app/run/result.hpp"
#include "dampline/effect/conclusion.hpp"
#include "dampline/effect/diagnosis.hpp"

namespace dampline::app {

/// Hann's weights over a second, their sum one.
[[nodiscard]] std::vector<double> mean_weights(double rate_hz);

/// A truck's force sample by sample: -M z_b'' as measured (with the far truck's share, where that
/// is known), and as two models make it of the motion.
/// The motion is without what is slower than about 1 Hz; the same is taken off each force, as the
/// mean over a second with Hann's weights.
class TruckPoints {
 public:
  struct Outlets {
    std::function<void(const EvidencePoint&)> point;
    std::function<void()> gap;  ///< the next point does not follow the last one
  };
  TruckPoints(double sample_rate_hz, double moving_mass_kg, const effect::Explanation& explanation,
              Outlets outlets);
  /// What the Diagnosis made of its newest sample. Its scale must be that of the explanation's.
  /// Points get their time from the first sample.
  void take(const Sample& sample, const UpdateResult& result, const effect::Diagnosis& diagnosis);

 private:
  /// A row of columns that waits for the positions of the wheelsets.
  struct Waiting {
    effect::Row row;
    EvidencePoint point;
  };
  void restart();
  void start_row(std::int64_t tick, const Motion& motion, const effect::Diagnosis& diagnosis);
  void finish_row(std::int64_t tick, double wheelset1_m, double wheelset2_m);
  void filter(const EvidencePoint& point);

  double rate_hz_;
  double mass_kg_;
  const effect::Explanation& explanation_;
  Outlets outlets_;
  std::optional<std::int64_t> first_tick_;
  Motion last_motion_{};
  bool any_motion_{false};
  std::int64_t last_tick_{-2};
  std::array<DriftFreeIntegral, 2> position_;
  std::vector<Waiting> waiting_;  // ring by tick
  std::vector<double> weights_;   // of the mean over a second
  std::vector<EvidencePoint> held_;
  std::size_t held_count_{0};
};

}  // namespace dampline::app
