// SPDX-License-Identifier: MIT
#include "app/fleet/database.hpp"

#include <fmt/format.h>
#include <sqlite3.h>

#include <bit>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "app/error.hpp"
#include "app/fleet/schema.hpp"
#include "app/run/trust.hpp"
#include "drivers/text/whole_file.hpp"

namespace dampline::app::fleet {
namespace {

namespace fs = std::filesystem;

struct Finalize {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Statement = std::unique_ptr<sqlite3_stmt, Finalize>;

// As `order` of leaves.cpp has it: what is refused here a merge would leave out.
constexpr const char* kPut = R"sql(
insert into state values (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17, ?18)
on conflict (vehicle, truck, start_ns, record) do update set
  seq = excluded.seq, end_ns = excluded.end_ns, load = excluded.load,
  moving_mass_kg = excluded.moving_mass_kg, basis = excluded.basis, rate_hz = excluded.rate_hz,
  coulomb_n = excluded.coulomb_n, coulomb_std_n = excluded.coulomb_std_n,
  stiffness_npm = excluded.stiffness_npm, stiffness_std_npm = excluded.stiffness_std_npm,
  trust = excluded.trust, light = excluded.light, checksum = excluded.checksum, body = excluded.body
where (-state.seq, state.light, state.checksum) > (-excluded.seq, excluded.light, excluded.checksum)
)sql";

}  // namespace

class Database::Connection {
 public:
  Connection(const fs::path& file, Access access) : name_{file.string()} {
    const int flags =
        access == Access::kRead ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
    const int code = sqlite3_open_v2(name_.c_str(), &handle_, flags, nullptr);
    if (code != SQLITE_OK) fail();
    constexpr int kPatienceMs = 10'000;  // while another collector writes
    sqlite3_busy_timeout(handle_, kPatienceMs);
    if (access == Access::kWrite) {
      run("pragma journal_mode = wal");
      run(kSchema);
    }
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() { sqlite3_close(handle_); }

  void run(const char* sql) {
    if (sqlite3_exec(handle_, sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
  }
  [[nodiscard]] Statement prepare(const char* sql) {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(handle_, sql, -1, &statement, nullptr) != SQLITE_OK) fail();
    return Statement{statement};
  }
  /// True: there is a row.
  bool step(const Statement& statement) {
    const int code = sqlite3_step(statement.get());
    if (code != SQLITE_ROW && code != SQLITE_DONE) fail();
    return code == SQLITE_ROW;
  }
  [[nodiscard]] bool changed() const { return sqlite3_changes(handle_) > 0; }
  [[nodiscard]] std::mutex& mutex() { return mutex_; }

 private:
  [[noreturn]] void fail() const {
    throw RunError{fmt::format("{}: {}", name_, sqlite3_errmsg(handle_))};
  }
  std::string name_;
  sqlite3* handle_{nullptr};
  std::mutex mutex_;
};

namespace {

void set(const Statement& statement, int at, std::string_view text) {
  sqlite3_bind_text(statement.get(), at, text.data(), static_cast<int>(text.size()),
                    SQLITE_TRANSIENT);
}
void set(const Statement& statement, int at, std::int64_t number) {
  sqlite3_bind_int64(statement.get(), at, number);
}
/// What is no number becomes null.
void set(const Statement& statement, int at, double number) {
  sqlite3_bind_double(statement.get(), at, number);
}

std::string text_at(const Statement& statement, int column) {
  const auto* const text =
      reinterpret_cast<const char*>(sqlite3_column_text(statement.get(), column));
  return text == nullptr ? "" : text;
}

std::string blob_at(const Statement& statement, int column) {
  const auto* const bytes = static_cast<const char*>(sqlite3_column_blob(statement.get(), column));
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement.get(), column));
  return bytes == nullptr ? "" : std::string{bytes, size};
}

void set_segment(const Statement& statement, const Segment& segment) {
  set(statement, 1, segment.vehicle);
  set(statement, 2, segment.truck);
  set(statement, 3, segment.start_ns);
  set(statement, 4, std::bit_cast<std::int64_t>(segment.record));
}

}  // namespace

bool is_database(const fs::path& file) {
  constexpr std::string_view kMagic = "SQLite format 3";
  std::string head;
  const auto read = drivers::read_parts(file.string(), [&](std::span<const char> part) {
    head.append(part.data(), part.size());
    return head.size() < kMagic.size();
  });
  return read.ok() && head.starts_with(kMagic);
}

Database::Database(fs::path file, Access access)
    : file_{std::move(file)}, connection_{std::make_shared<Connection>(file_, access)} {}

void Database::begin() { connection_->run("begin immediate"); }
void Database::commit() { connection_->run("commit"); }

Stored Database::put(const Leaf& leaf, const std::string& bytes) {
  const StateAbout& about = leaf.about;
  const Statement known = connection_->prepare(
      "select 1 from state where vehicle = ?1 and truck = ?2 and start_ns = ?3 and record = ?4");
  set_segment(known, about.segment);
  const bool is_known = connection_->step(known);
  const Statement put = connection_->prepare(kPut);
  set_segment(put, about.segment);
  set(put, 5, static_cast<std::int64_t>(about.sequence));
  set(put, 6, about.end_ns);
  set(put, 7, about.load);
  set(put, 8, about.moving_mass_kg);
  set(put, 9, fmt::format("{:016x}", leaf.header.basis_hash));
  set(put, 10, about.rate_hz.value);
  set(put, 11, about.coulomb_n.value);
  set(put, 12, about.coulomb_n.std);
  set(put, 13, about.stiffness_npm.value);
  set(put, 14, about.stiffness_npm.std);
  set(put, 15, name_of(about.trust));
  set(put, 16, std::int64_t{leaf.light ? 1 : 0});
  set(put, 17, std::int64_t{leaf.checksum});
  sqlite3_bind_blob64(put.get(), 18, bytes.data(), bytes.size(), SQLITE_TRANSIENT);
  connection_->step(put);
  if (!is_known) return Stored::kNew;
  return connection_->changed() ? Stored::kLater : Stored::kKnown;
}

void Database::refuse(const std::string& file, const std::string& reason) {
  const Statement put = connection_->prepare("insert or replace into refused values (?1, ?2)");
  set(put, 1, file);
  set(put, 2, reason);
  connection_->step(put);
}

std::uint64_t Database::states() const {
  const Statement count = connection_->prepare("select count(*) from state");
  connection_->step(count);
  return static_cast<std::uint64_t>(sqlite3_column_int64(count.get(), 0));
}

std::vector<Leaf> Database::leaves() const {
  std::vector<Segment> segments;
  const Statement all = connection_->prepare(
      "select vehicle, truck, start_ns, record from state order by 1, 2, 3, 4");
  while (connection_->step(all))
    segments.push_back({text_at(all, 0), text_at(all, 1), sqlite3_column_int64(all.get(), 2),
                        std::bit_cast<std::uint64_t>(sqlite3_column_int64(all.get(), 3))});
  std::vector<Leaf> out;
  const auto scratch = std::make_unique<Statistics>();
  for (const Segment& segment : segments) {
    const auto read = [connection = connection_, segment] {
      const std::lock_guard lock{connection->mutex()};
      const Statement body = connection->prepare(
          "select body from state where vehicle = ?1 and truck = ?2 and start_ns = ?3 and "
          "record = ?4");
      set_segment(body, segment);
      return connection->step(body) ? blob_at(body, 0) : std::string{};
    };
    out.push_back(leaf_of(fmt::format("{}:{}/{}/{}", file_.string(), segment.vehicle, segment.truck,
                                      segment.start_ns),
                          read, *scratch));
  }
  return out;
}

}  // namespace dampline::app::fleet
