// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "app/diagnosis/common/residual.hpp"
#include "dampline/result.hpp"
#include "dampline/sample.hpp"

namespace dampline::app {

/// The truck under the other end of the body. It runs over the same rail, so its frame does what
/// this one did or will do a while apart, but for what each pushes the other through the body.
struct OtherTruck {
  Estimate mass_kg{};  ///< of the body at the other truck: M_other of docs/theory.md
  Estimate delay_s{};  ///< of its motion behind this frame's; negative: it is ahead
  std::int64_t first_tick{0};
  std::vector<float> accel_mps2;  ///< of its frame, from first_tick on
  /// The sample with its acceleration as that of a sensor on the other frame.
  [[nodiscard]] Sample beside(Sample sample) const noexcept;
};

/// What the other truck's frame does is made of this one's: with equal trucks, D the dynamic mass
/// of each and e = exp(-i w T),
///   D a_1 + M_other a_2 = u,   D a_2 + M_other a_1 = e u
///   a_2 = e a_1 - (M_other / D) (a_1 - e a_2),   D = M - 2 (k + i w c) / w^2
/// with the friction's equivalent damping c = Fc sqrt(2 / pi) / rms of v (Gaussian motion).
struct FrameLaw {
  double mass_kg{0.0};
  double stiffness_npm{0.0};
  double coulomb_n{0.0};
  double velocity_rms_mps{0.0};
};

/// Keeps a record of up to an hour and looks in what is left of the force for the other truck.
class OtherTruckSearch {
 public:
  explicit OtherTruckSearch(double sample_rate_hz) : rate_hz_{sample_rate_hz} {}
  void clear();
  /// Each sample that is read.
  void take(const Sample& sample);
  /// What a model leaves; its time is from the first sample.
  void add(const EvidencePoint& point);
  /// None where nothing, or more than one delay, tells of one.
  [[nodiscard]] std::optional<OtherTruck> find(const FrameLaw& law) const;

 private:
  double rate_hz_;
  std::optional<std::int64_t> first_tick_;
  std::vector<float> frame_mps2_;  // by tick; 0 where there is none
  std::vector<float> left_n_, deflection_m_, velocity_mps_, final_n_;
  bool too_long_{false};
};

}  // namespace dampline::app
