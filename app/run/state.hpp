// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <tuple>

#include "app/run/result.hpp"
#include "dampline/estimate/statistics.hpp"

namespace dampline::app {

/// Which stretch of which truck's service a state is of. Two states of one segment are the same
/// stretch, seen for a shorter and a longer time.
struct Segment {
  std::string vehicle, truck;  ///< of [record]
  std::int64_t start_ns{0};    ///< of the first sample, UTC since 1970; 0: its record has no date
  std::uint64_t record{0};     ///< by which a record without a date is known: the beginning of its
                               ///< SHA-256; else 0
  bool operator==(const Segment&) const = default;
  bool operator<(const Segment& other) const {
    return std::tie(vehicle, truck, start_ns, record) <
           std::tie(other.vehicle, other.truck, other.start_ns, other.record);
  }
};

/// What a state is of, beside its sums.
struct StateAbout {
  Segment segment;             ///< of a merge of several: the first one's start, common names
  std::uint64_t sequence{0};   ///< samples so far: of two states of a segment the larger one counts
  std::uint32_t segments{1};   ///< merged into it
  std::int64_t end_ns{0};      ///< of the newest sample, as the start
  std::string load;            ///< of [record]
  double moving_mass_kg{0.0};  ///< 0: not known, as in states of version 1
  Estimate rate_hz;            ///< by the record's own time; 0: could not be measured
  bool viscous{false};         ///< whether the law asked for has a viscous part
  Trust trust{Trust::kNotIdentified};
  Estimate coulomb_n, stiffness_npm;  ///< of this state alone, as its parameters.json has them
  /// Of a segment of a live run: those of [alarm] that were raised in it, "coulomb_below, drift".
  std::string alarms;
};

/// How the factors are kept: all of them, or in single precision those of the whole alone.
enum class StateKind : std::uint8_t { kFull, kLight };

/// state.dls, the sufficient statistics of a run: docs/state_format.md. A light state has no
/// entries: merged, all of it counts as one.
[[nodiscard]] std::string encode_state(const Statistics& statistics, const StateAbout& about = {},
                                       StateKind kind = StateKind::kFull);

/// What it is of. Throws RunError naming `origin` when the bytes are no state, are cut off or
/// changed, or are of another version or other sizes; `out` is then not touched.
StateAbout decode_state(std::string_view bytes, const std::string& origin, Statistics& out);

/// Of bytes that decode.
[[nodiscard]] bool is_light_state(std::string_view bytes);

/// The same from a file.
StateAbout load_state(const std::filesystem::path& file, Statistics& out);

/// What keeps `other` from being added to `first`, which are of another basis: "its nominal sample
/// rate is 400 Hz, expected 300 Hz"; empty: nothing.
[[nodiscard]] std::string other_basis(const StatisticsHeader& first, const StatisticsHeader& other);

/// Adds the state `from`, which errors call `origin`. Throws RunError with the reason, and changes
/// nothing, when the two were made with another basis.
void merge_state(Statistics& into, const Statistics& from, const std::string& origin);

}  // namespace dampline::app
