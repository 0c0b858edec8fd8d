// SPDX-License-Identifier: MIT
#include "app/fleet/page/view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <tuple>

#include "app/error.hpp"
#include "app/text/format.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app::fleet::page {
namespace {

using store::Cell;
using store::Connection;
using store::Query;

constexpr std::int64_t kListed = 50;  // a page's longest list; CSV has all

/// Reads one state of all tables, whatever is written meanwhile.
class Reading {
 public:
  explicit Reading(Connection& connection) : connection_{connection} {
    connection_.begin(store::Access::kRead);
  }
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;
  ~Reading() {
    try {
      connection_.rollback();
    } catch (const std::exception&) {  // the connection is gone, and its transaction with it
    }
  }

 private:
  Connection& connection_;
};

std::optional<Estimate> estimate_of(const Query& query, int column) {
  if (query.cell(column) == Cell::kNull) return std::nullopt;
  return Estimate{query.number(column), query.number(column + 1)};
}

template <class Row>
std::vector<Row> all_of(Query& query, Row (*read)(const Query&)) {
  std::vector<Row> out;
  while (query.step()) out.push_back(read(query));
  return out;
}

TruckFigures figures_of(const Query& q) {
  return {q.text(0),
          q.text(1),
          {q.text(2), q.number(3)},
          q.text(4),
          {estimate_of(q, 5), estimate_of(q, 7), estimate_of(q, 9), estimate_of(q, 11)}};
}
constexpr const char* kFigures =
    "select vehicle, truck, load, moving_mass_kg, last_contact_utc, level_n, level_std_n, "
    "change_n, "
    "change_std_n, trend_n_per_year, trend_std_n_per_year, stiffness_npm, stiffness_std_npm "
    "from trend order by load, moving_mass_kg, level_n, vehicle, truck";

TruckContact contact_of(const Query& q) {
  return {q.text(0),    q.text(1),    q.text(2),   q.text(3),   q.text(4),
          q.integer(5), q.integer(6), q.number(7), q.integer(8)};
}
constexpr const char* kContacts =
    "select vehicle, truck, last_contact_utc, newest_trust, newest_alarms, segments, "
    "faulty_segments, hours, last_ns from truck ";

void read_totals(Connection& connection, Fleet& out) {
  const auto totals = connection.query(
      "select count(distinct vehicle), count(*), cast(coalesce(sum(segments), 0) as bigint), "
      "coalesce(sum(hours), 0.0), coalesce(max(last_ns), 0), coalesce(max(last_contact_utc), '') "
      "from truck");
  totals->step();
  out.cars = totals->integer(0);
  out.trucks = totals->integer(1);
  out.segments = totals->integer(2);
  out.hours = totals->number(3);
  out.last_ns = totals->integer(4);
  out.last_contact_utc = totals->text(5);
  const auto refused = connection.query("select count(*) from refused");
  refused->step();
  out.refused = refused->integer(0);
}

void read_contacts(Connection& connection, Fleet& out) {
  const auto read = connection.query(kContacts);
  std::vector<TruckContact> all = all_of(*read, contact_of);
  std::sort(all.begin(), all.end(), [](const TruckContact& a, const TruckContact& b) {
    return std::tie(a.last_ns, a.vehicle, a.truck) < std::tie(b.last_ns, b.vehicle, b.truck);
  });
  const auto add = [](First<TruckContact>& list, const TruckContact& truck) {
    if (++list.all <= kListed) list.rows.push_back(truck);
  };
  for (const TruckContact& truck : all)
    if (truck.last_ns != 0 && out.last_ns - truck.last_ns > kSilentNs) add(out.silent, truck);
  std::reverse(all.begin(), all.end());
  for (const TruckContact& truck : all) {
    if (truck.newest_trust == "data_faulty") add(out.faulty, truck);
    if (truck.newest_alarms.empty()) continue;
    add(out.alarmed, truck);
    for (const std::string& name : parts_of_list(truck.newest_alarms)) ++out.alarms[name];
  }
}

struct View {
  std::string_view name;
  const char* order;  ///< by what names a row
};
constexpr std::array<View, 8> kViews{{
    {"truck", "vehicle, truck"},
    {"trend", "vehicle, truck, load, moving_mass_kg"},
    {"month", "vehicle, truck, load, moving_mass_kg, month"},
    {"segment", "vehicle, truck, start_ns, record"},
    {"figure", "vehicle, truck, load, moving_mass_kg, quantity"},
    {"norm", "load, moving_mass_kg, quantity"},
    {"outlier", "vehicle, truck, load, moving_mass_kg, quantity"},
    {"refused", "file"},
}};

const View* find_view(std::string_view name) {
  const auto* const found = std::find_if(kViews.begin(), kViews.end(),
                                         [&](const View& view) { return view.name == name; });
  return found == kViews.end() ? nullptr : found;
}

bool names_vehicles(const View& view) {
  return std::string_view{view.order}.starts_with("vehicle");
}

std::string csv_cell(const Query& row, int column) {
  switch (row.cell(column)) {
    case Cell::kNull:
      return "";
    case Cell::kInteger:
      return fmt::format("{}", row.integer(column));
    case Cell::kNumber:
      return fmt::format("{}", row.number(column));
    case Cell::kText:
      break;
  }
  std::string text = row.text(column);
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string{"\"\""} : std::string{c};
  return quoted + "\"";
}

}  // namespace

Fleet read_fleet(Connection& connection) {
  const Reading reading{connection};
  Fleet out;
  read_totals(connection, out);
  read_contacts(connection, out);
  out.figures = all_of(*connection.query(kFigures), figures_of);
  out.norms = norms_of(out.figures);
  out.outliers = outliers_of(out.figures, out.norms);
  return out;
}

First<CarRow> read_cars(Connection& connection, std::int64_t first, std::int64_t count,
                        const std::vector<Outlier>& outliers) {
  const Reading reading{connection};
  First<CarRow> out;
  const auto number = connection.query("select count(distinct vehicle) from trend");
  number->step();
  out.all = number->integer(0);
  const auto cars = connection.query(
      "select vehicle, max(last_contact_utc), count(*), cast(sum(segments) as bigint), "
      "cast(sum(faulty_segments) as bigint) from truck group by vehicle order by vehicle "
      "limit $1 offset $2");
  cars->set(1, count);
  cars->set(2, first);
  while (cars->step())
    out.rows.push_back(
        {cars->text(0), cars->text(1), cars->integer(2), cars->integer(3), cars->integer(4), 0});
  for (CarRow& row : out.rows)
    row.outliers = std::count_if(outliers.begin(), outliers.end(),
                                 [&](const Outlier& o) { return o.vehicle == row.vehicle; });
  return out;
}

std::optional<Car> read_car(Connection& connection, const std::string& vehicle,
                            const Fleet& fleet) {
  const Reading reading{connection};
  const auto of_vehicle = [&](const std::string& sql) {
    auto query = connection.query(sql.c_str());
    query->set(1, vehicle);
    return query;
  };
  Car out;
  out.vehicle = vehicle;
  out.trucks =
      all_of(*of_vehicle(std::string{kContacts} + "where vehicle = $1 order by truck"), contact_of);
  if (out.trucks.empty()) return std::nullopt;
  const auto trends = of_vehicle(
      "select truck, load, moving_mass_kg, segments, usable_segments, faulty_segments, hours, "
      "first_ns, last_ns, newest_trust, newest_alarms, mean_n, mean_std_n, level_n, level_std_n, "
      "change_n, "
      "change_std_n, trend_n_per_year, trend_std_n_per_year, scatter, stiffness_npm, "
      "stiffness_std_npm from trend where vehicle = $1 order by truck, load, moving_mass_kg");
  while (trends->step()) {
    const Query& q = *trends;
    const auto scatter = q.cell(19) == Cell::kNull ? std::nullopt : std::optional{q.number(19)};
    out.trends.push_back(
        {q.text(0),
         {q.text(1), q.number(2), q.integer(3), q.integer(4), q.integer(5), q.number(6),
          q.integer(7), q.integer(8), q.text(9), q.text(10), estimate_of(q, 11), estimate_of(q, 13),
          estimate_of(q, 15), estimate_of(q, 17), scatter, estimate_of(q, 20)}});
  }
  const auto segments = of_vehicle(
      "select truck, start_utc, load, moving_mass_kg, start_ns, end_ns, hours, coulomb_n, "
      "coulomb_std_n, stiffness_npm, stiffness_std_npm, trust, usable, alarms from segment "
      "where vehicle = $1 order by truck, start_ns, record");
  while (segments->step()) {
    const Query& q = *segments;
    out.segments.push_back({q.text(0),
                            q.text(1),
                            {q.text(2), q.number(3), q.integer(4), q.integer(5), q.number(6),
                             estimate_of(q, 7).value_or(Estimate{}), estimate_of(q, 9), q.text(11),
                             q.integer(12) == 1, q.text(13)}});
  }
  out.norms = fleet.norms;
  std::copy_if(fleet.outliers.begin(), fleet.outliers.end(), std::back_inserter(out.outliers),
               [&](const Outlier& o) { return o.vehicle == vehicle; });
  return out;
}

bool is_view(std::string_view name) { return find_view(name) != nullptr; }

std::string view_names() {
  std::vector<std::string_view> names;
  names.reserve(std::size(kViews));
  for (const View& view : kViews) names.push_back(view.name);
  return list_words(names);
}

std::string view_csv(Connection& connection, std::string_view name,
                     const std::optional<std::string>& vehicle) {
  const View* const view = find_view(name);
  if (view == nullptr)
    throw UsageError{fmt::format("found {}, expected {}", drivers::quote(name), view_names())};
  const Reading reading{connection};
  const bool of_one = vehicle && names_vehicles(*view);
  const auto query = connection.query(fmt::format("select * from {}{} order by {}", view->name,
                                                  of_one ? " where vehicle = $1" : "", view->order)
                                          .c_str());
  if (of_one) query->set(1, *vehicle);
  bool row = query->step();
  std::string out;
  for (int i = 0; i < query->columns(); ++i) {
    if (i > 0) out += ',';
    out += query->name(i);
  }
  for (; row; row = query->step()) {
    out += '\n';
    for (int i = 0; i < query->columns(); ++i) {
      if (i > 0) out += ',';
      out += csv_cell(*query, i);
    }
  }
  out += '\n';
  return out;
}

}  // namespace dampline::app::fleet::page
