// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "app/run/result.hpp"

namespace dampline::app {

/// One row of a rig's record in canonical units. A value that is not there is NaN.
struct RigLine {
  std::uint64_t line{0};  ///< of the file, from 1; 0: not known
  double time_s{0.0};
  double deflection_m{0.0};
  double velocity_mps{std::numeric_limits<double>::quiet_NaN()};
  double force_n{0.0};
  double accel_mps2{std::numeric_limits<double>::quiet_NaN()};
};

/// A rig's record, row by row.
class RigSource {
 public:
  RigSource() = default;
  RigSource(const RigSource&) = delete;
  RigSource& operator=(const RigSource&) = delete;
  virtual ~RigSource() = default;
  /// False at the end. Throws RunError naming file and line for a row that cannot be read.
  virtual bool next(RigLine& line) = 0;
  [[nodiscard]] virtual bool has_velocity() const = 0;
  /// At the end: what was skipped, cut off or not used, into the result's counts and notes.
  virtual void report(RunResult& result) const = 0;
};

/// A record is read several times; each call starts it from its beginning.
struct RigRecord {
  std::string name;  ///< what errors call it
  std::function<std::unique_ptr<RigSource>()> open;
  std::vector<std::string> notes{};  ///< what was done to the rows, a sentence each
};

}  // namespace dampline::app
