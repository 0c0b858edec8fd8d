// SPDX-License-Identifier: MIT
// Segments by vehicle, truck, load or month.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "app/fleet/leaves.hpp"
#include "app/run/result.hpp"

namespace dampline::app::fleet {

enum class By : std::uint8_t { kVehicle, kTruck, kLoad, kMonth };

/// "vehicle,truck": throws UsageError naming a word that is none of the four, or is there twice.
[[nodiscard]] std::vector<By> parse_by(const std::string& words);
[[nodiscard]] const char* name_of(By by) noexcept;

struct Group {
  std::vector<std::string> labels;  ///< one for each By; empty: the states do not say
  std::vector<Leaf> leaves;         ///< in the order of their segments
  /// Of a directory: labels with dots between, "unknown" for none.
  [[nodiscard]] std::string name() const;
};

/// In the order of their labels. Month: of the start in UTC, "2026-11". Load: as [record] names
/// it, else the mass, "37200 kg". One group, without labels, where `by` is empty.
[[nodiscard]] std::vector<Group> group(std::vector<Leaf> leaves, const std::vector<By>& by);

/// What became of a group, for tables.
struct GroupRow {
  std::vector<std::string> labels;
  std::size_t segments{0};
  RunResult result;
  std::string run;  ///< its directory
};

/// A table for the terminal; groups.csv; merge.json ("dampline.merge/1").
[[nodiscard]] std::string to_text(const std::vector<By>& by, const std::vector<GroupRow>& rows);
[[nodiscard]] std::string to_csv(const std::vector<By>& by, const std::vector<GroupRow>& rows);
[[nodiscard]] std::string to_json(const std::vector<By>& by, const std::vector<GroupRow>& rows,
                                  const std::vector<LeftOut>& left_out);

}  // namespace dampline::app::fleet
