// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dampline/snapshot.hpp"

namespace dampline::app {

/// A stretch of the record, in seconds from its beginning.
struct Span {
  double start_s{0.0};
  double end_s{0.0};
};

/// A fault of sensor or transport, as parameters.json and the report name it.
struct FaultFinding {
  std::string name;     ///< "clipping", "lost_samples", ...
  std::string channel;  ///< "frame", "wheelset1", "wheelset2", "wheelsets", "all"
  double time_s{0.0};   ///< first seen, from the beginning of the record
  double last_s{0.0};
  double size{0.0};  ///< of several events the largest, of samples their sum
  std::string unit;
  std::uint64_t count{0};   ///< events, or blocks where it has no events
  std::vector<Span> spans;  ///< seconds that faults of this name spoil; capped
};

/// A parameter that changed while the record was made.
struct DriftFinding {
  std::string parameter;    ///< "coulomb", "stiffness", "moving_mass"
  bool step{false};         ///< at once; else slowly over the whole record
  double time_s{0.0};       ///< of the step, in moving time
  double interval_s{0.0};   ///< of uncertainty of that time
  double gain{0.0};         ///< share of the held-out error that it explains
  Estimate change_percent;  ///< after it, or at the end, against before
};

/// What the guards make of a record.
struct DataFaults {
  std::vector<FaultFinding> list;
  std::uint64_t impacts{0};        ///< rail joints, wheel flats: input, not faults
  std::uint64_t speed_changes{0};  ///< input, too
  std::optional<DriftFinding> drift;
};

/// "+12.1 ± 0.9 % at 150 s" and the like.
[[nodiscard]] std::string describe_drift(const DriftFinding& drift);

}  // namespace dampline::app
