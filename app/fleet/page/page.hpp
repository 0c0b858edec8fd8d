// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <string>

#include "app/fleet/page/view.hpp"

namespace dampline::app::fleet::page {

/// A page by itself has all it needs within; a served one takes style and scripts from its server,
/// and leads to cars and tables.
enum class Kind : std::uint8_t { kAlone, kServed };

/// `where`: the database, as errors call it.
[[nodiscard]] std::string fleet_page(const Fleet& fleet, const std::string& where, Kind kind);
[[nodiscard]] std::string car_page(const Car& car, const std::string& where, Kind kind);
/// A list of all cars by name, from number `first` on.
inline constexpr std::int64_t kCarsOnPage = 200;
[[nodiscard]] std::string cars_page(const First<CarRow>& cars, std::int64_t first);

/// The same for a terminal.
[[nodiscard]] std::string fleet_text(const Fleet& fleet);
/// The same as JSON.
[[nodiscard]] std::string fleet_json(const Fleet& fleet);
/// The same for Prometheus: totals, norms and outliers; no series for each truck.
[[nodiscard]] std::string fleet_metrics(const Fleet& fleet);

// What the pages share.

/// Between head and end of a page; `note` stands under the heading.
[[nodiscard]] std::string framed(const std::string& title, const std::string& body, Kind kind);
/// Where a served page of a car is: "/car?vehicle=...".
[[nodiscard]] std::string car_link(const std::string& vehicle, Kind kind);
[[nodiscard]] std::string vehicle_text(const std::string& vehicle);
[[nodiscard]] std::string load_text(const Load& load);
/// Value and deviation as people read them.
[[nodiscard]] std::string estimate_text(const std::optional<Estimate>& estimate,
                                        const std::string& unit);
/// Lists of figures that lie outside, one row each.
[[nodiscard]] std::string outlier_table(const std::vector<Outlier>& outliers, Kind kind);

}  // namespace dampline::app::fleet::page
