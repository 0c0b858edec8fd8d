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
  std::vector<Span> spans;  ///< seconds that it spoils; capped
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

/// The live alarm: a parameter is not what it was when the watch began.
struct AlarmFinding {
  std::string parameter;  ///< "coulomb", "stiffness", "moving_mass"
  double change_percent{0.0};
  double since_s{0.0};  ///< from the beginning of the record
  double time_s{0.0};   ///< when it was told
};

/// What the live alarm is worth, from simulated months in which weather moves friction by 2 % over
/// a day and 1 % from day to day; `bench/months` measures it.
struct AlarmFigures {
  double false_alarms_per_1000_h{0.011};  ///< of motion: 2 in 180,000 h
  double delay_s{240.0};                  ///< median, in motion, friction 10 % less at once
  double delay_95_s{480.0};               ///< of 95 % of them
};

/// What the guards make of a record.
struct DataFaults {
  std::vector<FaultFinding> list;
  std::uint64_t impacts{0};          ///< rail joints, wheel flats: input, not faults
  std::uint64_t speed_changes{0};    ///< input, too
  std::uint64_t values_replaced{0};  ///< single wrong samples, by what their neighbours say
  std::uint64_t samples_spoilt{0};   ///< left out because of a fault that passed
  std::optional<DriftFinding> drift;
  std::vector<AlarmFinding> alarms;  ///< the newest
};

/// "+12.1 ± 0.9 % at 150 s" and the like.
[[nodiscard]] std::string describe_drift(const DriftFinding& drift);
/// "coulomb changed by -12.1 % since 4210 s, told at 4450 s".
[[nodiscard]] std::string describe_alarm(const AlarmFinding& alarm);
/// How late the live alarm is and how often it is wrong, in a sentence.
[[nodiscard]] std::string describe_alarm_figures();

}  // namespace dampline::app
