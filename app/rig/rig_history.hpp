// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <vector>

#include "app/run/result.hpp"
#include "dampline/rig/rig_identifier.hpp"
#include "dampline/rig/rig_predictor.hpp"

namespace dampline::app {

/// Name and unit of a parameter as in parameters.json.
[[nodiscard]] const char* rig_parameter_name(RigParameter parameter) noexcept;
[[nodiscard]] const char* rig_parameter_unit(RigParameter parameter) noexcept;

/// How the parameters of one model developed: a row per sixtieth of the record.
class RigHistory {
 public:
  RigHistory(const RigTerms& terms, const RigSnapshot& last, std::int64_t ticks, double rate_hz);
  void take(std::int64_t tick, const RigIdentifier& identifier);
  [[nodiscard]] const Convergence& convergence() const noexcept { return convergence_; }

 private:
  static constexpr std::int64_t kRows = 60;

  RigTerms terms_;
  std::vector<RigParameter> parameters_;
  std::int64_t interval_;
  std::int64_t next_;
  double rate_hz_;
  Convergence convergence_;
};

/// The first 20 s in which the rig moves, thinned to at most kMost rows.
class RigExcerpt {
 public:
  RigExcerpt(double still_mps, double rate_hz);
  void take(const RigPrediction& prediction);
  void move_to(RunResult& result);

 private:
  static constexpr double kLengthSeconds = 20.0;
  static constexpr double kMost = 5000.0;

  double still_mps_;
  double rate_hz_;
  std::int64_t stride_;
  bool started_{false};
  std::int64_t first_tick_{0};
  std::vector<MotionRow> motion_;
  std::vector<ForceRow> force_;
};

}  // namespace dampline::app
