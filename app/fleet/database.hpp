// SPDX-License-Identifier: MIT
// The states of a fleet: the newest of each segment, in a file of SQLite or on a server.
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "app/fleet/leaves.hpp"
#include "app/fleet/store/store.hpp"

namespace dampline::app::fleet {

/// Whether it names a database: PostgreSQL's address, or a file that begins as SQLite's do.
[[nodiscard]] bool is_database(const std::filesystem::path& where);

/// What became of a state that was put in.
enum class Stored : std::uint8_t { kNew, kLater, kKnown };

/// Table `state`, a row for each segment; table `trend`, a row for each truck and load, which
/// commit() writes of the trucks that changed; views for people: docs/reference.md. The same tables
/// in both kinds of database. Every method throws RunError with the database's words.
class Database {
 public:
  using Access = store::Access;
  /// "postgresql://..." or a file of SQLite. kWrite makes what is missing.
  Database(const std::string& where, Access access);

  /// Between them nothing is seen by others, and nothing stays where the program ends.
  void begin();
  void commit();

  /// Keeps the state that counts of its segment, as a merge chooses it. Between begin() and
  /// commit(). Throws RunError for what no database can hold, before it is touched.
  [[nodiscard]] Stored put(const Leaf& leaf, const std::string& bytes);
  /// A file that held no state, and why; once. After an error of the database itself throws that.
  void refuse(const std::string& file, const std::string& reason);
  /// All rows of `trend` anew, in a transaction of its own.
  void renew_trends();

  [[nodiscard]] std::uint64_t states() const;
  /// All of them; the database stays open as long as one of them is there.
  [[nodiscard]] std::vector<Leaf> leaves() const;
  /// To read tables and views.
  [[nodiscard]] store::Connection& connection() const noexcept { return shared_->connection(); }

 private:
  /// Of leaves that may be read by several threads.
  class Shared {
   public:
    explicit Shared(std::unique_ptr<store::Connection> connection)
        : connection_{std::move(connection)} {}
    [[nodiscard]] store::Connection& connection() const noexcept { return *connection_; }
    [[nodiscard]] std::mutex& mutex() noexcept { return mutex_; }

   private:
    std::unique_ptr<store::Connection> connection_;
    std::mutex mutex_;
  };
  using Truck = std::pair<std::string, std::string>;  // vehicle, truck

  void make_tables();
  void write_trends(const Truck& truck);

  std::shared_ptr<Shared> shared_;
  std::set<Truck> changed_;
};

}  // namespace dampline::app::fleet
