// SPDX-License-Identifier: MIT
// A fleet as its tables and views have it, read in one transaction.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/fleet/store/store.hpp"
#include "app/fleet/trend.hpp"

/// What people see of a fleet: page, metrics, CSV.
namespace dampline::app::fleet::page {

/// The trucks that are compared with each other.
struct Load {
  std::string name;
  double moving_mass_kg{0.0};
  bool operator==(const Load&) const = default;
};

/// A row of view `norm`.
struct Norm {
  Load load;
  std::string quantity, unit;
  std::int64_t trucks{0};
  double median{0.0}, scatter{0.0};
};

/// A row of view `outlier`, the one that is farthest out first.
struct Outlier {
  std::string vehicle, truck;
  Load load;
  std::string quantity, unit;
  Estimate value;
  double median{0.0}, scatter{0.0}, deviations{0.0};
  std::string last_contact_utc;
};

/// What trucks are told apart by.
struct Quantity {
  std::string_view name, unit;
};
inline constexpr std::array<Quantity, 4> kQuantities{
    {{"level", "N"}, {"change", "N"}, {"trend", "N/year"}, {"stiffness", "N/m"}}};
inline constexpr std::size_t kLevel = 0, kTrend = 2;

/// A row of table `trend`: one truck with one load.
struct TruckFigures {
  std::string vehicle, truck;
  Load load;
  std::string last_contact_utc;
  std::array<std::optional<Estimate>, kQuantities.size()> values;  ///< of kQuantities
};

/// View `norm` of these: median and scatter of the trucks of each load. In C++, since a page that
/// ranks 10,000 trucks in SQL takes longer than its reader waits; tests hold both equal.
[[nodiscard]] std::vector<Norm> norms_of(const std::vector<TruckFigures>& trucks);
/// View `outlier` of these, the farthest first.
[[nodiscard]] std::vector<Outlier> outliers_of(const std::vector<TruckFigures>& trucks,
                                               const std::vector<Norm>& norms);

/// A row of view `truck`.
struct TruckContact {
  std::string vehicle, truck, last_contact_utc, newest_trust;
  std::string newest_alarms;  ///< raised in its newest segment
  std::int64_t segments{0}, faulty_segments{0};
  double hours{0.0};
  std::int64_t last_ns{0};
};

/// The first of a long list, and how long it is.
template <class Row>
struct First {
  std::vector<Row> rows;
  std::int64_t all{0};
};

struct Fleet {
  std::int64_t cars{0}, trucks{0}, segments{0}, refused{0};
  double hours{0.0};
  std::int64_t last_ns{0};
  std::string last_contact_utc;
  std::vector<Norm> norms;
  std::vector<Outlier> outliers;
  First<TruckContact> silent;                  ///< the longest silent first
  First<TruckContact> faulty;                  ///< whose newest segment faults of the data spoil
  First<TruckContact> alarmed;                 ///< in whose newest segment an alarm was raised
  std::map<std::string, std::int64_t> alarms;  ///< by name: of how many trucks
  std::vector<TruckFigures> figures;           ///< by load, then by level
};

/// Without contact for this long before the fleet's newest one: silent.
inline constexpr std::int64_t kSilentNs = kNewestNs;

[[nodiscard]] Fleet read_fleet(store::Connection& connection);

/// A car as one row of a list.
struct CarRow {
  std::string vehicle, last_contact_utc;
  std::int64_t trucks{0}, segments{0}, faulty_segments{0}, outliers{0};
};
/// Cars by name, `count` of them from number `first` on; `outliers` are the fleet's.
[[nodiscard]] First<CarRow> read_cars(store::Connection& connection, std::int64_t first,
                                      std::int64_t count, const std::vector<Outlier>& outliers);

/// One segment of a car's history.
struct CarSegment {
  std::string truck, start_utc;
  SegmentRow row;
};
struct CarTrend {
  std::string truck;
  Trend trend;
};
struct Car {
  std::string vehicle;
  std::vector<TruckContact> trucks;
  std::vector<CarTrend> trends;
  std::vector<CarSegment> segments;  ///< by truck and start
  std::vector<Norm> norms;           ///< of its fleet
  std::vector<Outlier> outliers;     ///< of this car
};
/// Nothing: no segment is of that vehicle.
[[nodiscard]] std::optional<Car> read_car(store::Connection& connection, const std::string& vehicle,
                                          const Fleet& fleet);

/// The views and tables that can be had as CSV.
[[nodiscard]] bool is_view(std::string_view name);
/// All of a view, the same from both kinds of database; of one vehicle where it is given. Throws
/// UsageError for another name.
[[nodiscard]] std::string view_csv(store::Connection& connection, std::string_view name,
                                   const std::optional<std::string>& vehicle);
/// "trend", "outlier", ..., for messages.
[[nodiscard]] std::string view_names();

}  // namespace dampline::app::fleet::page
