// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>

#include "dampline/damping/estimator.hpp"
#include "dampline/density/fokker_planck.hpp"

namespace dampline {

/// The methods beside the wavelet windows, fed by the motion that an Estimator gives. A companion
/// of fixed size; update() costs a bounded number of operations and allocates nothing.
class Methods {
 public:
  /// The same rate, nodes, filter and memory as the identifier's. A sliding window becomes
  /// forgetting of the same mean age.
  [[nodiscard]] static FokkerPlanckConfig fokker_planck_config(
      const EstimatorConfig& config) noexcept {
    FokkerPlanckConfig out;
    out.sample_rate_hz = config.sample_rate_hz;
    out.curve_nodes_mps = config.curve_nodes_mps;
    out.anti_alias_corner_hz = config.anti_alias.corner_hz;
    if (config.memory == Memory::kForgetting) out.memory_s = config.memory_s;
    if (config.memory == Memory::kWindow) out.memory_s = std::max(0.5 * config.memory_s, 2.0);
    return out;
  }

  /// Precondition: Estimator::check(config).ok().
  explicit Methods(const EstimatorConfig& config) noexcept
      : fokker_planck_{fokker_planck_config(config)} {}

  /// Takes what Estimator::update() returned.
  void update(const UpdateResult& result) noexcept {
    if (result.has_motion) fokker_planck_.update(result.motion);
  }

  [[nodiscard]] const FokkerPlanck& fokker_planck() const noexcept { return fokker_planck_; }

 private:
  FokkerPlanck fokker_planck_;
};

}  // namespace dampline
