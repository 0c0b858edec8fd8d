// SPDX-License-Identifier: MIT
// What the segments of one truck say together.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/run/result.hpp"

namespace dampline::app::fleet {

/// A row of table `state`, without the state.
struct SegmentRow {
  std::string load;
  double moving_mass_kg{0.0};
  std::int64_t start_ns{0};
  std::int64_t end_ns{0};
  double hours{0.0};
  Estimate coulomb_n;
  std::optional<Estimate> stiffness_npm;
  std::string trust;
  bool usable{false};
  std::string alarms;  ///< raised in it
};

/// A row of table `trend`: of one truck with one load.
struct Trend {
  std::string load;
  double moving_mass_kg{0.0};
  std::int64_t segments{0}, usable_segments{0}, faulty_segments{0};
  double hours{0.0};
  std::int64_t first_ns{0}, last_ns{0};
  std::string newest_trust, newest_alarms;
  std::optional<Estimate> mean_n;            ///< of all usable segments
  std::optional<Estimate> level_n;           ///< of the newest kNewest
  std::optional<Estimate> change_n;          ///< from the mean of those before
  std::optional<Estimate> trend_n_per_year;  ///< over all of them, at most the newest year's
  std::optional<double> scatter;             ///< about that line, in deviations of the segments
  std::optional<Estimate> stiffness_npm;     ///< as the level
};

/// Nanoseconds before the end of the newest usable segment whose level counts as today's.
inline constexpr std::int64_t kNewestNs = std::int64_t{7} * 24 * 3600 * 1'000'000'000;

/// Farther from the median of its load than this many standard deviations, of its own value and of
/// the trucks' scatter, a truck is an outlier; where there are fewer trucks, none is looked for.
/// As views.sql has them.
inline constexpr double kOutlierDeviations = 4.5;
inline constexpr int kLeastTrucks = 20;

/// A row for each load, by load and mass. `rows`: in the order of their starts.
[[nodiscard]] std::vector<Trend> trends_of(std::span<const SegmentRow> rows);

}  // namespace dampline::app::fleet
