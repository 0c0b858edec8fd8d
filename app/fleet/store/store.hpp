// SPDX-License-Identifier: MIT
// The SQL that SQLite and PostgreSQL share, and what differs between them.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace dampline::app::fleet::store {

enum class Access : std::uint8_t { kRead, kWrite };

/// What a cell holds, whatever its column was declared as.
enum class Cell : std::uint8_t { kNull, kInteger, kNumber, kText };

/// One statement. Its values are $1, $2, ... in the order in which the text first names them;
/// columns count from 0. Every method throws RunError with the database's words.
class Query {
 public:
  Query() = default;
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;
  virtual ~Query() = default;

  virtual void set(int at, std::string_view text) = 0;
  virtual void set(int at, std::int64_t number) = 0;
  /// What is no number becomes null.
  virtual void set(int at, double number) = 0;
  virtual void set_bytes(int at, std::string_view bytes) = 0;

  /// True: there is a row, the first or the next.
  virtual bool step() = 0;
  /// Rows written, after step().
  [[nodiscard]] virtual std::int64_t changed() const = 0;

  [[nodiscard]] virtual int columns() const = 0;
  [[nodiscard]] virtual std::string name(int column) const = 0;
  [[nodiscard]] virtual Cell cell(int column) const = 0;
  [[nodiscard]] virtual std::string text(int column) const = 0;
  [[nodiscard]] virtual std::int64_t integer(int column) const = 0;
  /// NaN where there is none.
  [[nodiscard]] virtual double number(int column) const = 0;
  [[nodiscard]] virtual std::string bytes(int column) const = 0;
};

/// A database that is open.
class Connection {
 public:
  Connection() = default;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  virtual ~Connection() = default;

  /// What errors call it: without a password.
  [[nodiscard]] virtual const std::string& name() const = 0;
  /// The first error since begin(), after which nothing more is written; empty: none.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }
  /// One or more statements without values.
  virtual void run(const char* sql) = 0;
  [[nodiscard]] virtual std::unique_ptr<Query> query(const char* sql) = 0;
  /// A transaction: kWrite waits for another writer's end, kRead sees one state of all tables.
  virtual void begin(Access access) = 0;
  void commit() { run("commit"); }
  void rollback() { run("rollback"); }
  /// The view `segment`, whose times are text: the one statement of the schema that each
  /// database has its own way of.
  [[nodiscard]] virtual const char* segment_view() const = 0;
  /// Whether a table of that name is there.
  [[nodiscard]] virtual bool has_table(const char* table) = 0;

 protected:
  /// Throws it.
  [[noreturn]] void fail_with(std::string_view words);
  void forget_failure() noexcept { failure_.clear(); }

 private:
  std::string failure_;
};

/// kWrite makes the file where it is missing.
[[nodiscard]] std::unique_ptr<Connection> open_sqlite(const std::string& file, Access access);
/// "postgresql://...", as libpq reads it. Throws UsageError in a program built without libpq.
[[nodiscard]] std::unique_ptr<Connection> open_postgresql(const std::string& uri, Access access);

[[nodiscard]] bool is_postgresql(std::string_view where);
/// A password that an address holds as "***".
[[nodiscard]] std::string without_password(const std::string& uri);

}  // namespace dampline::app::fleet::store
