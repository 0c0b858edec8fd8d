// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/inspect/values.hpp"
#include "dampline/sample.hpp"
#include "drivers/record/frames.hpp"

namespace dampline::app {

/// A signal of the DBC file, or a column of a table, as the record has it.
struct SignalFinding {
  std::string name;                  ///< MESSAGE.SIGNAL, or as the header says
  std::string unit;                  ///< as the DBC file or the header says; empty: it does not
  Values values;                     ///< in that unit
  std::optional<double> resolution;  ///< of the DBC file: one count; else the smallest step
  double rate_hz{0.0};
  bool acceleration{false};  ///< one that `identify` takes
  double in_mps2{0.0};       ///< of an acceleration: one unit
};

/// The frames of one identifier.
struct IdentifierFinding {
  std::uint32_t id{0};
  bool extended{false};
  std::string message;  ///< of the DBC file; empty: it has none of this identifier
  std::uint64_t frames{0};
  std::uint8_t least_length{0};  ///< bytes
  std::uint8_t most_length{0};
  double rate_hz{0.0};  ///< by the first and the last frame; 0: one frame
  double longest_pause_s{0.0};
  std::vector<SignalFinding> signals;
};

/// Which signal or column could be which accelerometer, and why.
struct Candidate {
  std::string name;
  std::string why;  ///< "by its name", "by its rms"
};

/// What a record or a bus holds.
struct Inspection {
  std::string source;
  std::string format;             ///< "a candump log", "a CAN interface", ...
  bool frames{false};             ///< else rows
  std::string dbc;                ///< that decoded the frames; empty: the project's own
  std::uint64_t count{0};         ///< frames, or rows
  std::optional<double> start_s;  ///< from 1970, where the record's times tell
  drivers::RecordClock clock{drivers::RecordClock::kRelative};
  double span_s{0.0};
  double rate_hz{0.0};    ///< of rows
  std::uint64_t gaps{0};  ///< see kGapS; of rows: more than 1.5 intervals
  double longest_gap_s{0.0};
  std::uint64_t malformed{0};
  std::uint64_t error_frames{0};
  std::vector<std::string> interfaces;
  std::vector<IdentifierFinding> identifiers;  ///< the busiest first
  std::vector<SignalFinding> columns;          ///< in the order of the header
  std::array<std::optional<Candidate>, kChannels> truck{};
  std::vector<std::string> notes;
  std::string configuration;  ///< to paste into a file; empty: there is none to propose

  static constexpr double kGapS = 0.1;  ///< between two frames, whatever their identifiers
};

struct InspectOptions {
  std::string source;
  std::string dbc;         ///< empty: the project's own sensors
  double duration_s{5.0};  ///< of a look at an interface
};

/// Reads a record from its beginning to its end, or listens to an interface. Throws RunError naming
/// what was found, what was expected and the way out for what cannot be read; UsageError for the
/// DBC file.
[[nodiscard]] Inspection inspect(const InspectOptions& options);

/// As lines for a terminal, and as JSON.
[[nodiscard]] std::string inspection_text(const Inspection& found);
[[nodiscard]] std::string inspection_json(const Inspection& found);

}  // namespace dampline::app
