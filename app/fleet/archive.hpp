// SPDX-License-Identifier: MIT
// A folder of logs becomes a folder of states, by any number of workers, as often as it takes.
//
//   OUT/archive.toml   the configuration that all of its states are of
//   OUT/states/        a state for each log
//   OUT/set_aside/     for each log that gave none, its name and the reason
//   OUT/merged/        the run directory of all of them
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "app/config/config.hpp"

namespace dampline::app::fleet {

/// A log, and how its work is known: by the name of its state without a suffix, which its place,
/// size and time of change give. A log that grew is another one, and its state a later one of its
/// segment.
struct Log {
  std::filesystem::path file;
  std::uint64_t bytes{0};
  std::string name;
};

/// Files as they are given, and of directories, to any depth, what has the suffix of a record. The
/// largest first: they are dealt out in turn. Throws RunError where there is none.
[[nodiscard]] std::vector<Log> find_logs(const std::vector<std::string>& sources);

/// Which of the logs a worker takes: number i where i % of == part.
struct Part {
  std::size_t part{0};
  std::size_t of{1};
};

/// What happened to some logs.
struct Tally {
  std::size_t logs{0};
  std::size_t made{0};
  std::size_t before{0};  ///< there already, states or set aside
  std::size_t set_aside{0};
  std::uint64_t bytes{0};  ///< of the logs that were read
  double seconds{0.0};
};

struct ArchiveOptions {
  Config config;
  std::vector<std::string> folders;  ///< "vehicle", "truck", "load", "": names of a log's folders
  std::filesystem::path out;
  int jobs{1};
  bool skip_bad_lines{false};
  bool progress{false};
};

class Archive {
 public:
  /// Makes the folders, and removes what a killed worker left. Throws UsageError where OUT was made
  /// with another configuration or holds something else, or the configuration is not a truck's;
  /// IoError.
  explicit Archive(ArchiveOptions options);

  /// Makes the states that are missing, by `jobs` threads. What a log is at fault for is written
  /// beside it; throws IoError where a state cannot be written.
  [[nodiscard]] Tally run(const std::vector<Log>& logs, const Part& part = {}) const;

  /// Forgets that these were set aside.
  void try_again(const std::vector<Log>& logs) const;

  [[nodiscard]] std::filesystem::path states() const { return options_.out / "states"; }
  [[nodiscard]] std::filesystem::path merged() const { return options_.out / "merged"; }

  struct SetAside {
    std::string log;
    std::string reason;
  };
  /// All that are set aside, by any worker, in the order of their logs.
  [[nodiscard]] std::vector<SetAside> set_aside() const;

 private:
  [[nodiscard]] bool is_done(const Log& log) const;
  /// False: set aside.
  [[nodiscard]] bool make_state(const Log& log) const;
  [[nodiscard]] Config config_of(const Log& log) const;

  ArchiveOptions options_;
};

/// The words of --folders: "vehicle/truck". Throws UsageError.
[[nodiscard]] std::vector<std::string> parse_folders(const std::string& words);

}  // namespace dampline::app::fleet
