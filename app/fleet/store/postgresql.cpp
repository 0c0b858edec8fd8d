// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <libpq-fe.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "app/fleet/store/store.hpp"

namespace dampline::app::fleet::store {
namespace {

constexpr const char* kPostgresqlSegment = R"sql(
create view segment as
select vehicle, truck,
  to_char(to_timestamp(nullif(start_ns, 0) / 1000000000) at time zone 'UTC', 'YYYY-MM-DD HH24:MI:SS') as start_utc,
  to_char(to_timestamp(nullif(end_ns, 0) / 1000000000) at time zone 'UTC', 'YYYY-MM-DD HH24:MI:SS') as end_utc,
  to_char(to_timestamp(nullif(start_ns, 0) / 1000000000) at time zone 'UTC', 'YYYY-MM') as month,
  hours, load, moving_mass_kg, coulomb_n, coulomb_std_n, stiffness_npm, stiffness_std_npm, trust,
  alarms, usable, start_ns, end_ns, record, seq, basis, rate_hz, light
from state
)sql";

struct Clear {
  void operator()(PGresult* result) const { PQclear(result); }
};
using Answer = std::unique_ptr<PGresult, Clear>;

class Postgresql final : public Connection {
 public:
  Postgresql(const std::string& uri, Access access)
      : name_{without_password(uri)}, handle_{PQconnectdb(uri.c_str())} {
    if (PQstatus(handle_.get()) != CONNECTION_OK) fail();
    PQsetNoticeProcessor(
        handle_.get(), [](void*, const char*) {}, nullptr);
    if (PQsetClientEncoding(handle_.get(), "UTF8") != 0) fail();
    if (access == Access::kRead)
      run("set session characteristics as transaction isolation level repeatable read read only");
  }

  [[nodiscard]] const std::string& name() const override { return name_; }
  void run(const char* sql) override { check(Answer{PQexec(handle_.get(), sql)}); }
  [[nodiscard]] std::unique_ptr<Query> query(const char* sql) override;
  void begin(Access access) override {
    forget_failure();
    run("begin");
    // One writer at a time, as SQLite has it: two that bring the same segments in another order
    // would wait for each other.
    if (access == Access::kWrite) run("select pg_advisory_xact_lock(5071200413)");
  }
  [[nodiscard]] const char* segment_view() const override { return kPostgresqlSegment; }
  [[nodiscard]] bool has_table(const char* table) override {
    const auto known = query("select 1 where to_regclass($1) is not null");
    known->set(1, std::string_view{table});
    return known->step();
  }

  Answer check(Answer answer) {
    const ExecStatusType status = PQresultStatus(answer.get());
    if (status != PGRES_COMMAND_OK && status != PGRES_TUPLES_OK) fail();
    return answer;
  }
  [[nodiscard]] PGconn* handle() const noexcept { return handle_.get(); }

 private:
  struct Finish {
    void operator()(PGconn* connection) const { PQfinish(connection); }
  };
  [[noreturn]] void fail() {
    std::string_view words = PQerrorMessage(handle_.get());
    while (words.ends_with('\n')) words.remove_suffix(1);
    fail_with(words);
  }
  std::string name_;
  std::unique_ptr<PGconn, Finish> handle_;
};

/// Values and rows travel as text, which for numbers is exact; bytes as they are.
class PostgresqlQuery final : public Query {
 public:
  PostgresqlQuery(Postgresql& connection, const char* sql) : connection_{connection}, sql_{sql} {}

  void set(int at, std::string_view text) override { value(at, false) = text; }
  void set(int at, std::int64_t number) override { value(at, false) = fmt::format("{}", number); }
  void set(int at, double number) override {
    if (std::isnan(number))
      value(at, false).reset();
    else
      value(at, false) = fmt::format("{}", number);
  }
  void set_bytes(int at, std::string_view bytes) override { value(at, true) = bytes; }

  bool step() override {
    if (!answer_) {
      execute();
      row_ = 0;
    } else {
      ++row_;
    }
    return row_ < PQntuples(answer_.get());
  }
  [[nodiscard]] std::int64_t changed() const override {
    const std::string_view count = PQcmdTuples(answer_.get());
    std::int64_t out = 0;
    std::from_chars(count.data(), count.data() + count.size(), out);
    return out;
  }

  [[nodiscard]] int columns() const override { return PQnfields(answer_.get()); }
  [[nodiscard]] std::string name(int column) const override {
    return PQfname(answer_.get(), column);
  }
  [[nodiscard]] Cell cell(int column) const override {
    constexpr Oid kInt8 = 20;
    constexpr Oid kInt4 = 23;
    constexpr Oid kFloat8 = 701;
    if (PQgetisnull(answer_.get(), row_, column) != 0) return Cell::kNull;
    switch (PQftype(answer_.get(), column)) {
      case kInt8:
      case kInt4:
        return Cell::kInteger;
      case kFloat8:
        return Cell::kNumber;
      default:
        return Cell::kText;
    }
  }
  [[nodiscard]] std::string text(int column) const override { return std::string{view(column)}; }
  [[nodiscard]] std::int64_t integer(int column) const override {
    const std::string_view text = view(column);
    std::int64_t out = 0;
    std::from_chars(text.data(), text.data() + text.size(), out);
    return out;
  }
  [[nodiscard]] double number(int column) const override {
    const std::string_view text = view(column);
    double out = std::numeric_limits<double>::quiet_NaN();
    std::from_chars(text.data(), text.data() + text.size(), out);  // "Infinity" too
    return out;
  }
  [[nodiscard]] std::string bytes(int column) const override {
    struct Free {
      void operator()(unsigned char* memory) const { PQfreemem(memory); }
    };
    std::size_t size = 0;
    const std::unique_ptr<unsigned char, Free> plain{PQunescapeBytea(
        reinterpret_cast<const unsigned char*>(PQgetvalue(answer_.get(), row_, column)), &size)};
    return plain ? std::string{reinterpret_cast<const char*>(plain.get()), size} : std::string{};
  }

 private:
  [[nodiscard]] std::string_view view(int column) const {
    return {PQgetvalue(answer_.get(), row_, column),
            static_cast<std::size_t>(PQgetlength(answer_.get(), row_, column))};
  }
  std::optional<std::string>& value(int at, bool binary) {
    const auto count = static_cast<std::size_t>(at);
    if (values_.size() < count) {
      values_.resize(count);
      formats_.resize(count, 0);
    }
    formats_[count - 1] = binary ? 1 : 0;
    return values_[count - 1];
  }
  void execute() {
    std::vector<const char*> pointers;
    std::vector<int> lengths;
    for (const std::optional<std::string>& value : values_) {
      pointers.push_back(value ? value->c_str() : nullptr);
      lengths.push_back(value ? static_cast<int>(value->size()) : 0);
    }
    answer_ = connection_.check(
        Answer{PQexecParams(connection_.handle(), sql_.c_str(), static_cast<int>(values_.size()),
                            nullptr, pointers.data(), lengths.data(), formats_.data(), 0)});
  }

  Postgresql& connection_;
  std::string sql_;
  std::vector<std::optional<std::string>> values_;
  std::vector<int> formats_;
  Answer answer_;
  int row_{0};
};

std::unique_ptr<Query> Postgresql::query(const char* sql) {
  return std::make_unique<PostgresqlQuery>(*this, sql);
}

}  // namespace

std::unique_ptr<Connection> open_postgresql(const std::string& uri, Access access) {
  return std::make_unique<Postgresql>(uri, access);
}

}  // namespace dampline::app::fleet::store
