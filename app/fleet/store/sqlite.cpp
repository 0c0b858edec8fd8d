// SPDX-License-Identifier: MIT
#include <sqlite3.h>

#include <cmath>
#include <limits>
#include <utility>

#include "app/error.hpp"
#include "app/fleet/store/store.hpp"

namespace dampline::app::fleet::store {
namespace {

constexpr const char* kSqliteSegment = R"sql(
create view segment as
select vehicle, truck, datetime(nullif(start_ns, 0) / 1000000000, 'unixepoch') as start_utc,
  datetime(nullif(end_ns, 0) / 1000000000, 'unixepoch') as end_utc,
  strftime('%Y-%m', nullif(start_ns, 0) / 1000000000, 'unixepoch') as month,
  hours, load, moving_mass_kg, coulomb_n, coulomb_std_n, stiffness_npm, stiffness_std_npm, trust,
  alarms, usable, start_ns, end_ns, record, seq, basis, rate_hz, light
from state
)sql";

class Sqlite;

class SqliteQuery final : public Query {
 public:
  SqliteQuery(Sqlite& connection, const char* sql);
  ~SqliteQuery() override { sqlite3_finalize(statement_); }
  SqliteQuery(const SqliteQuery&) = delete;
  SqliteQuery& operator=(const SqliteQuery&) = delete;

  void set(int at, std::string_view text) override {
    sqlite3_bind_text(statement_, at, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
  }
  void set(int at, std::int64_t number) override { sqlite3_bind_int64(statement_, at, number); }
  void set(int at, double number) override { sqlite3_bind_double(statement_, at, number); }
  void set_bytes(int at, std::string_view bytes) override {
    sqlite3_bind_blob64(statement_, at, bytes.data(), bytes.size(), SQLITE_TRANSIENT);
  }
  bool step() override;
  [[nodiscard]] std::int64_t changed() const override;

  [[nodiscard]] int columns() const override { return sqlite3_column_count(statement_); }
  [[nodiscard]] std::string name(int column) const override {
    return sqlite3_column_name(statement_, column);
  }
  [[nodiscard]] Cell cell(int column) const override {
    switch (sqlite3_column_type(statement_, column)) {
      case SQLITE_NULL:
        return Cell::kNull;
      case SQLITE_INTEGER:
        return Cell::kInteger;
      case SQLITE_FLOAT:
        return Cell::kNumber;
      default:
        return Cell::kText;
    }
  }
  [[nodiscard]] std::string text(int column) const override {
    const auto* const text = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    return text == nullptr ? "" : text;
  }
  [[nodiscard]] std::int64_t integer(int column) const override {
    return sqlite3_column_int64(statement_, column);
  }
  [[nodiscard]] double number(int column) const override {
    return cell(column) == Cell::kNull ? std::numeric_limits<double>::quiet_NaN()
                                       : sqlite3_column_double(statement_, column);
  }
  [[nodiscard]] std::string bytes(int column) const override {
    const auto* const bytes = static_cast<const char*>(sqlite3_column_blob(statement_, column));
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
    return bytes == nullptr ? "" : std::string{bytes, size};
  }

 private:
  Sqlite& connection_;
  sqlite3_stmt* statement_{nullptr};
};

class Sqlite final : public Connection {
 public:
  Sqlite(std::string file, Access access) : name_{std::move(file)} {
    const int flags =
        access == Access::kRead ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
    const int code = sqlite3_open_v2(name_.c_str(), &handle_, flags, nullptr);
    try {
      if (code != SQLITE_OK) fail();
      constexpr int kPatienceMs = 10'000;  // while another collector writes
      sqlite3_busy_timeout(handle_, kPatienceMs);
      if (access == Access::kWrite) run("pragma journal_mode = wal");
    } catch (const RunError&) {
      sqlite3_close(handle_);
      throw;
    }
  }
  Sqlite(const Sqlite&) = delete;
  Sqlite& operator=(const Sqlite&) = delete;
  ~Sqlite() override { sqlite3_close(handle_); }

  [[nodiscard]] const std::string& name() const override { return name_; }
  void run(const char* sql) override {
    if (sqlite3_exec(handle_, sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
  }
  [[nodiscard]] std::unique_ptr<Query> query(const char* sql) override {
    return std::make_unique<SqliteQuery>(*this, sql);
  }
  void begin(Access access) override {
    forget_failure();
    run(access == Access::kWrite ? "begin immediate" : "begin deferred");
  }
  [[nodiscard]] const char* segment_view() const override { return kSqliteSegment; }
  [[nodiscard]] bool has_table(const char* table) override {
    const auto known = query("select 1 from sqlite_master where type = 'table' and name = $1");
    known->set(1, std::string_view{table});
    return known->step();
  }
  [[noreturn]] void fail() { fail_with(sqlite3_errmsg(handle_)); }
  [[nodiscard]] sqlite3* handle() const noexcept { return handle_; }

 private:
  std::string name_;
  sqlite3* handle_{nullptr};
};

SqliteQuery::SqliteQuery(Sqlite& connection, const char* sql) : connection_{connection} {
  if (sqlite3_prepare_v2(connection.handle(), sql, -1, &statement_, nullptr) != SQLITE_OK)
    connection.fail();
}

bool SqliteQuery::step() {
  const int code = sqlite3_step(statement_);
  if (code != SQLITE_ROW && code != SQLITE_DONE) connection_.fail();
  return code == SQLITE_ROW;
}

std::int64_t SqliteQuery::changed() const { return sqlite3_changes64(connection_.handle()); }

}  // namespace

std::unique_ptr<Connection> open_sqlite(const std::string& file, Access access) {
  return std::make_unique<Sqlite>(file, access);
}

}  // namespace dampline::app::fleet::store
