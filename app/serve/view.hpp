// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <deque>
#include <memory>
#include <string>

#include "app/config/config.hpp"
#include "app/identify/collected.hpp"
#include "app/run/result.hpp"
#include "dampline/density/fokker_planck.hpp"
#include "dampline/phase/view.hpp"

namespace dampline::app {

/// What the page draws and live.json does not hold: the curve, how level and stiffness developed,
/// the newest seconds of motion, densities, planes, events. Densities and planes are the core's,
/// fed with the motion that the acquisition handed on. By the nominal rate; bounded memory.
class LiveView {
 public:
  static constexpr double kShownS = 20.0;

  /// Throws as estimator_config() does.
  explicit LiveView(const Config& config);

  /// The newest motion; ticks increase.
  void take(const Motion& motion, std::int64_t first_tick);
  /// The newest result.
  void take(const RunResult& result);

  /// view.json.
  [[nodiscard]] std::string document(std::uint64_t sequence) const;
  /// {"t","y","v"} in s, m, m/s: what came since the last call, of the shown seconds.
  [[nodiscard]] std::string newest_motion();
  /// All the shown seconds.
  [[nodiscard]] std::string shown_motion() const;
  /// Of the newest motion, from the beginning of the record.
  [[nodiscard]] double motion_time_s() const noexcept { return motion_time_s_; }

 private:
  struct Point {
    double time_s;
    double deflection_m;
    double velocity_mps;
  };
  using Points = std::deque<Point>;

  double rate_hz_;
  std::int64_t stride_;
  std::unique_ptr<PhaseView> phase_;
  std::unique_ptr<FokkerPlanck> density_;
  ConvergenceHistory history_;
  Points shown_;
  std::size_t told_{0};  ///< of shown_, counted from its end: how many were not told yet
  std::int64_t last_tick_{0};
  bool any_{false};
  double motion_time_s_{0.0};
  RunResult result_;
};

}  // namespace dampline::app
