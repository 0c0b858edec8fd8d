// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "app/config/config.hpp"
#include "app/rig/record.hpp"
#include "app/run/result.hpp"
#include "dampline/rig/config.hpp"
#include "dampline/rig/identifier.hpp"
#include "dampline/rig/predictor.hpp"

namespace dampline::app::rig {

/// The terms of a rig's force from [model]: base, inertia, stiffness. "auto" means no spring: a
/// force cell on a damper measures the damper alone, and friction with memory would pass for a
/// spring. Throws UsageError naming the effect that cannot be identified from a rig, or effects
/// that exclude each other.
[[nodiscard]] core::Terms terms_of(const ModelConfig& model);

/// Effects of [model] base that are no term: `explain` finds their lengths and speeds, and puts
/// them into the base.
[[nodiscard]] std::vector<std::string> searched_base(const ModelConfig& model);

/// Effect names of the terms, the linear ones first: "moving_mass", "linear spring", "coulomb", ...
[[nodiscard]] std::vector<std::string> term_names(const core::Terms& terms);

/// Name and unit of a parameter as in parameters.json.
[[nodiscard]] const char* parameter_name(core::Parameter parameter) noexcept;
[[nodiscard]] const char* parameter_unit(core::Parameter parameter) noexcept;

/// How the parameters of one model developed: a row per sixtieth of the record.
class History {
 public:
  History(const core::Terms& terms, const core::Snapshot& last, std::int64_t ticks, double rate_hz);
  void take(std::int64_t tick, const core::Identifier& identifier);
  [[nodiscard]] const Convergence& convergence() const noexcept { return convergence_; }

 private:
  static constexpr std::int64_t kRows = 60;

  core::Terms terms_;
  std::vector<core::Parameter> parameters_;
  std::int64_t interval_;
  std::int64_t next_;
  double rate_hz_;
  Convergence convergence_;
};

/// The first 20 s in which the rig moves, thinned to at most kMost rows.
class Excerpt {
 public:
  Excerpt(double still_mps, double rate_hz);
  void take(const core::Prediction& prediction);
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

/// What is known of a rig's record when it is over.
struct Findings {
  core::Terms terms;
  core::Config config;
  core::Snapshot snapshot;
  core::Errors errors;
  /// Where no spring was in the model: what one would change.
  std::optional<core::Snapshot> with_spring;
  std::int64_t ticks{0};
  std::uint64_t still_samples{0};
  int latency_samples{0};
};

/// Parameters, curve, counts, fit, verdicts and notes.
[[nodiscard]] RunResult result_of(const Findings& findings);

}  // namespace dampline::app::rig
