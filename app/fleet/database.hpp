// SPDX-License-Identifier: MIT
// The states of a fleet in one file, SQLite's: the newest of each segment.
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/fleet/leaves.hpp"

namespace dampline::app::fleet {

/// Whether the file begins as SQLite's do.
[[nodiscard]] bool is_database(const std::filesystem::path& file);

/// What became of a state that was put in.
enum class Stored : std::uint8_t { kNew, kLater, kKnown };

/// Table `state`, a row for each segment; views `truck` and `month` for people: docs/reference.md.
/// Every method throws RunError with SQLite's words.
class Database {
 public:
  enum class Access : std::uint8_t { kRead, kWrite };
  /// kWrite makes it where it is missing.
  Database(std::filesystem::path file, Access access);

  /// Between them nothing is seen by others, and nothing stays where the program ends.
  void begin();
  void commit();

  /// Keeps the state that counts of its segment, as a merge chooses it.
  [[nodiscard]] Stored put(const Leaf& leaf, const std::string& bytes);
  /// A file that held no state, and why; once.
  void refuse(const std::string& file, const std::string& reason);

  [[nodiscard]] std::uint64_t states() const;
  /// All of them; the database stays open as long as one of them is there.
  [[nodiscard]] std::vector<Leaf> leaves() const;

 private:
  class Connection;
  std::filesystem::path file_;
  std::shared_ptr<Connection> connection_;
};

}  // namespace dampline::app::fleet
