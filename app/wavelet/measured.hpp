// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "app/config/config.hpp"
#include "app/record/feed.hpp"
#include "app/run/result.hpp"

namespace dampline::app::wavelet {

/// Samples that follow each other at the step, [begin, end).
struct Stretch {
  std::size_t begin{0};
  std::size_t end{0};
};

/// A record as the method needs it: what each mass does, and what acts on it. Samples that are no
/// numbers are left out; a gap ends a stretch. Outer index: mass.
struct Measured {
  std::string name;  ///< what errors call it
  int masses{1};
  /// The deflection was integrated from accelerations against the base, in windows: each stretch is
  /// one of them. `force_n` is then the acceleration of the base with the sign turned, m/s^2, which
  /// becomes a force with the mass.
  bool from_accelerations{false};
  double step_s{0.0};
  std::vector<double> time_s;  ///< from the beginning of the record
  std::array<std::vector<double>, 2> deflection_m;
  std::array<std::vector<double>, 2> force_n;
  std::vector<Stretch> stretches;
  /// Where from accelerations: of each stretch the middle, without the guards.
  std::vector<Stretch> blocks;
  double file_force_sign{1.0};  ///< -1: the file has the force with the other sign
  double duration_s{0.0};
  /// Counts, excluded stretches, notes and warnings of the reading.
  RunResult reading;
  std::vector<std::string> notes;

  [[nodiscard]] std::size_t samples() const noexcept { return time_s.size(); }
};

struct MeasuredOptions {
  SourceOptions source;
  int masses{1};
  double block_s{4.0};  ///< of accelerations; half of it stands as a guard on each side
};

/// One mass: columns of a rig as everywhere, or base_accel_mps2 and response_accel_mps2. Two
/// masses: deflection1_m, deflection2_m with force1_n, force2_n (or one of them), or
/// base_accel_mps2 with response1_accel_mps2, response2_accel_mps2. Other names are recognised by
/// their words, numbers and units. Throws RunError naming file, column or line.
[[nodiscard]] Measured read_measured(const Config& config, const MeasuredOptions& options);

/// Fine samples in a period of the motion of an element: from reversal to reversal, twice; of two
/// masses the shorter one. 0: it does not turn.
[[nodiscard]] double samples_per_period(const Measured& measured);

}  // namespace dampline::app::wavelet
