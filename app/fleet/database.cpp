// SPDX-License-Identifier: MIT
#include "app/fleet/database.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "app/error.hpp"
#include "app/fleet/schema.hpp"
#include "app/fleet/trend.hpp"
#include "app/run/provenance.hpp"
#include "app/run/trust.hpp"
#include "drivers/text/quote.hpp"
#include "drivers/text/whole_file.hpp"

namespace dampline::app::fleet {
namespace {

namespace fs = std::filesystem;
using store::Query;

// As `order` of leaves.cpp has it: what is refused here a merge would leave out.
constexpr const char* kPut = R"sql(
insert into state (vehicle, truck, start_ns, record, seq, end_ns, load, moving_mass_kg, basis,
  rate_hz, coulomb_n, coulomb_std_n, stiffness_npm, stiffness_std_npm, trust, light, checksum,
  hours, usable, alarms, body)
values ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15, $16, $17, $18, $19, $20,
  $21)
on conflict (vehicle, truck, start_ns, record) do update set
  seq = excluded.seq, end_ns = excluded.end_ns, load = excluded.load,
  moving_mass_kg = excluded.moving_mass_kg, basis = excluded.basis, rate_hz = excluded.rate_hz,
  coulomb_n = excluded.coulomb_n, coulomb_std_n = excluded.coulomb_std_n,
  stiffness_npm = excluded.stiffness_npm, stiffness_std_npm = excluded.stiffness_std_npm,
  trust = excluded.trust, light = excluded.light, checksum = excluded.checksum,
  hours = excluded.hours, usable = excluded.usable, alarms = excluded.alarms,
  body = excluded.body
where state.seq < excluded.seq or (state.seq = excluded.seq and
  (state.light > excluded.light or (state.light = excluded.light and state.checksum > excluded.checksum)))
)sql";

constexpr const char* kRowsOfTruck =
    "select load, moving_mass_kg, start_ns, end_ns, hours, coulomb_n, coulomb_std_n, "
    "stiffness_npm, stiffness_std_npm, trust, usable, alarms from state where vehicle = $1 and "
    "truck = $2 order by start_ns, record";

constexpr const char* kPutTrend = R"sql(
insert into trend (vehicle, truck, load, moving_mass_kg, segments, usable_segments, faulty_segments,
  hours, first_ns, last_ns, last_contact_utc, newest_trust, newest_alarms, mean_n, mean_std_n, level_n,
  level_std_n, change_n, change_std_n, trend_n_per_year, trend_std_n_per_year, scatter,
  stiffness_npm, stiffness_std_npm)
values ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, nullif($11, ''), $12, $13, $14, $15, $16, $17, $18,
  $19, $20, $21, $22, $23, $24)
)sql";

/// Numbers whose squares and quotients a database can form.
bool is_plausible(const Estimate& e) {
  constexpr double kMost = 1e12;
  constexpr double kLeastStd = 1e-6;
  return std::abs(e.value) < kMost && e.std >= kLeastStd && e.std < kMost;
}

void set(Query& query, int at, const std::optional<Estimate>& estimate) {
  query.set(at, estimate ? estimate->value : std::nan(""));
  query.set(at + 1, estimate ? estimate->std : std::nan(""));
}

std::optional<Estimate> estimate_at(const Query& query, int column) {
  if (query.cell(column) == store::Cell::kNull) return std::nullopt;
  return Estimate{query.number(column), query.number(column + 1)};
}

std::optional<Estimate> plausible(const Estimate& e) {
  return is_plausible(e) ? std::optional{e} : std::nullopt;
}

void set_segment(Query& query, const Segment& segment) {
  query.set(1, segment.vehicle);
  query.set(2, segment.truck);
  query.set(3, segment.start_ns);
  query.set(4, std::bit_cast<std::int64_t>(segment.record));
}

double hours_of(const Leaf& leaf) {
  constexpr double kHourS = 3600.0;
  const double measured = leaf.about.rate_hz.value;
  const double rate_hz = measured > 0.0 ? measured : leaf.header.sample_rate_hz;
  const double hours = static_cast<double>(leaf.about.sequence) / rate_hz / kHourS;
  return std::isfinite(hours) ? hours : 0.0;
}

/// What came from outside as both databases can keep it.
void check_texts(const Leaf& leaf) {
  const StateAbout& about = leaf.about;
  for (const std::string* text :
       {&about.segment.vehicle, &about.segment.truck, &about.load, &about.alarms})
    if (drivers::printable(*text) != *text)
      throw RunError{fmt::format("{}: names {}, expected text without control characters, in UTF-8",
                                 leaf.file.string(), drivers::quote(*text))};
  if (about.sequence > static_cast<std::uint64_t>(INT64_MAX))
    throw RunError{fmt::format("{}: counts {} samples, more than any record has",
                               leaf.file.string(), about.sequence)};
}

bool is_usable(const StateAbout& about) {
  return (about.trust == Trust::kTrusted || about.trust == Trust::kModelIncomplete) &&
         is_plausible(about.coulomb_n);
}

std::unique_ptr<store::Connection> open(const std::string& where, store::Access access) {
  return store::is_postgresql(where) ? store::open_postgresql(where, access)
                                     : store::open_sqlite(where, access);
}

}  // namespace

bool is_database(const fs::path& where) {
  if (store::is_postgresql(where.string())) return true;
  constexpr std::string_view kMagic = "SQLite format 3";
  std::string head;
  const auto read = drivers::read_parts(where.string(), [&](std::span<const char> part) {
    head.append(part.data(), part.size());
    return head.size() < kMagic.size();
  });
  return read.ok() && head.starts_with(kMagic);
}

Database::Database(const std::string& where, Access access)
    : shared_{std::make_shared<Shared>(open(where, access))} {
  if (access == Access::kWrite) {
    begin();
    if (!connection().has_table("fleet_schema")) make_tables();
    connection().commit();
  }
  if (!connection().has_table("fleet_schema"))
    throw RunError{
        fmt::format("{}: holds no fleet; `dampline collect` makes one", connection().name())};
  const auto version = connection().query("select version from fleet_schema");
  if (!version->step() || version->integer(0) != kSchemaVersion)
    throw RunError{fmt::format("{}: was made by another version of dampline; expected tables {}",
                               connection().name(), kSchemaVersion)};
}

void Database::make_tables() {
  store::Connection& c = connection();
  c.run(kTables);
  c.run(c.segment_view());
  c.run(kViews);
  c.run(fmt::format("insert into fleet_schema values ({})", kSchemaVersion).c_str());
}

void Database::begin() { connection().begin(Access::kWrite); }

void Database::commit() {
  for (const Truck& truck : changed_) write_trends(truck);
  changed_.clear();
  connection().commit();
}

Stored Database::put(const Leaf& leaf, const std::string& bytes) {
  const StateAbout& about = leaf.about;
  check_texts(leaf);
  const auto known = connection().query(
      "select 1 from state where vehicle = $1 and truck = $2 and start_ns = $3 and record = $4");
  set_segment(*known, about.segment);
  const bool is_known = known->step();
  const auto put = connection().query(kPut);
  set_segment(*put, about.segment);
  put->set(5, static_cast<std::int64_t>(about.sequence));
  put->set(6, about.end_ns);
  put->set(7, about.load);
  put->set(8, about.moving_mass_kg);
  put->set(9, fmt::format("{:016x}", leaf.header.basis_hash));
  put->set(10, about.rate_hz.value);
  set(*put, 11, plausible(about.coulomb_n));
  set(*put, 13, plausible(about.stiffness_npm));
  put->set(15, std::string_view{name_of(about.trust)});
  put->set(16, std::int64_t{leaf.light ? 1 : 0});
  put->set(17, std::int64_t{leaf.checksum});
  put->set(18, hours_of(leaf));
  put->set(19, std::int64_t{is_usable(about) ? 1 : 0});
  put->set(20, about.alarms);
  put->set_bytes(21, bytes);
  put->step();
  const bool is_written = put->changed() > 0;
  if (is_written) changed_.emplace(about.segment.vehicle, about.segment.truck);
  if (!is_known) return Stored::kNew;
  return is_written ? Stored::kLater : Stored::kKnown;
}

void Database::refuse(const std::string& file, const std::string& reason) {
  // It is not the file's fault.
  if (!connection().failure().empty()) throw RunError{connection().failure()};
  const auto put = connection().query(
      "insert into refused (file, reason) values ($1, $2) on conflict (file) do update set reason "
      "= excluded.reason");
  put->set(1, drivers::printable(file));
  put->set(2, drivers::printable(reason));
  put->step();
}

void Database::write_trends(const Truck& truck) {
  const auto read = connection().query(kRowsOfTruck);
  read->set(1, truck.first);
  read->set(2, truck.second);
  std::vector<SegmentRow> rows;
  while (read->step())
    rows.push_back({read->text(0), read->number(1), read->integer(2), read->integer(3),
                    read->number(4), estimate_at(*read, 5).value_or(Estimate{}),
                    estimate_at(*read, 7), read->text(9), read->integer(10) == 1, read->text(11)});
  const auto remove = connection().query("delete from trend where vehicle = $1 and truck = $2");
  remove->set(1, truck.first);
  remove->set(2, truck.second);
  remove->step();
  for (const Trend& trend : trends_of(rows)) {
    const auto put = connection().query(kPutTrend);
    put->set(1, truck.first);
    put->set(2, truck.second);
    put->set(3, trend.load);
    put->set(4, trend.moving_mass_kg);
    put->set(5, trend.segments);
    put->set(6, trend.usable_segments);
    put->set(7, trend.faulty_segments);
    put->set(8, trend.hours);
    put->set(9, trend.first_ns);
    put->set(10, trend.last_ns);
    constexpr std::size_t kToTheSecond = 19;
    std::string contact = trend.last_ns == 0 ? "" : utc_text(trend.last_ns).substr(0, kToTheSecond);
    if (const std::size_t t = contact.find('T'); t != std::string::npos) contact[t] = ' ';
    put->set(11, contact);
    put->set(12, trend.newest_trust);
    put->set(13, trend.newest_alarms);
    set(*put, 14, trend.mean_n);
    set(*put, 16, trend.level_n);
    set(*put, 18, trend.change_n);
    set(*put, 20, trend.trend_n_per_year);
    put->set(22, trend.scatter.value_or(std::nan("")));
    set(*put, 23, trend.stiffness_npm);
    put->step();
  }
}

void Database::renew_trends() {
  begin();
  connection().run("delete from trend");
  const auto all = connection().query("select distinct vehicle, truck from state");
  while (all->step()) changed_.emplace(all->text(0), all->text(1));
  commit();
}

std::uint64_t Database::states() const {
  const auto count = connection().query("select count(*) from state");
  count->step();
  return static_cast<std::uint64_t>(count->integer(0));
}

std::vector<Leaf> Database::leaves() const {
  std::vector<Segment> segments;
  const auto all =
      connection().query("select vehicle, truck, start_ns, record from state order by 1, 2, 3, 4");
  while (all->step())
    segments.push_back({all->text(0), all->text(1), all->integer(2),
                        std::bit_cast<std::uint64_t>(all->integer(3))});
  std::vector<Leaf> out;
  const auto scratch = std::make_unique<Statistics>();
  for (const Segment& segment : segments) {
    const auto read = [shared = shared_, segment] {
      const std::lock_guard lock{shared->mutex()};
      const auto body = shared->connection().query(
          "select body from state where vehicle = $1 and truck = $2 and start_ns = $3 and record "
          "= $4");
      set_segment(*body, segment);
      return body->step() ? body->bytes(0) : std::string{};
    };
    out.push_back(leaf_of(fmt::format("{}:{}/{}/{}", connection().name(), segment.vehicle,
                                      segment.truck, segment.start_ns),
                          read, *scratch));
  }
  return out;
}

}  // namespace dampline::app::fleet
