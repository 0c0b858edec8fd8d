// SPDX-License-Identifier: MIT
#include "app/rig/rig_history.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace dampline::app {
namespace {

struct Text {
  const char* name;
  const char* unit;
};

/// Indexed by RigParameter.
constexpr std::array<Text, 10> kTexts{{{"moving_mass", "kg"},
                                       {"stiffness", "N/m"},
                                       {"viscous", "N s/m"},
                                       {"viscous_positive", "N s/m"},
                                       {"viscous_negative", "N s/m"},
                                       {"coulomb", "N"},
                                       {"coulomb_positive", "N"},
                                       {"coulomb_negative", "N"},
                                       {"offset", "N"},
                                       {"slope", "N s/m"}}};

Estimate find(const RigSnapshot& snapshot, RigParameter parameter) {
  for (std::size_t i = 0; i < snapshot.size; ++i)
    if (snapshot.estimates[i].parameter == parameter) return snapshot.estimates[i].estimate;
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  return {kUnknown, kUnknown};
}

}  // namespace

const char* rig_parameter_name(RigParameter parameter) noexcept {
  return kTexts[static_cast<std::size_t>(parameter)].name;
}
const char* rig_parameter_unit(RigParameter parameter) noexcept {
  return kTexts[static_cast<std::size_t>(parameter)].unit;
}

RigHistory::RigHistory(const RigTerms& terms, const RigSnapshot& last, std::int64_t ticks,
                       double rate_hz)
    : terms_{terms},
      interval_{std::max<std::int64_t>(1, ticks / kRows)},
      next_{interval_},
      rate_hz_{rate_hz} {
  for (std::size_t i = 0; i < last.size; ++i) {
    parameters_.push_back(last.estimates[i].parameter);
    convergence_.names.emplace_back(rig_parameter_name(parameters_.back()));
    convergence_.units.emplace_back(rig_parameter_unit(parameters_.back()));
  }
}

void RigHistory::take(std::int64_t tick, const RigIdentifier& identifier) {
  if (tick < next_) return;
  while (next_ <= tick) next_ += interval_;
  const RigSnapshot snapshot = identifier.snapshot(terms_);
  if (!snapshot.valid || snapshot.size < parameters_.size()) return;
  Convergence::Row row{static_cast<double>(tick) / rate_hz_, {}};
  for (const RigParameter parameter : parameters_)
    row.estimates.push_back(find(snapshot, parameter));
  convergence_.rows.push_back(std::move(row));
}

RigExcerpt::RigExcerpt(double still_mps, double rate_hz)
    : still_mps_{still_mps},
      rate_hz_{rate_hz},
      stride_{static_cast<std::int64_t>(std::ceil(kLengthSeconds * rate_hz / kMost))} {}

void RigExcerpt::take(const RigPrediction& prediction) {
  if (!started_) {
    if (std::abs(prediction.velocity_mps) <= still_mps_) return;
    started_ = true;
    first_tick_ = prediction.tick;
  }
  const std::int64_t since = prediction.tick - first_tick_;
  if (since % stride_ != 0 || static_cast<double>(since) > kLengthSeconds * rate_hz_) return;
  const double time_s = static_cast<double>(prediction.tick) / rate_hz_;
  motion_.push_back({time_s, prediction.deflection_m, prediction.velocity_mps});
  force_.push_back({time_s, prediction.velocity_mps, prediction.measured_n, prediction.fitted_n});
}

void RigExcerpt::move_to(RunResult& result) {
  result.motion = std::move(motion_);
  result.force = std::move(force_);
}

}  // namespace dampline::app
