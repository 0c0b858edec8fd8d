// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tests/bus/child.hpp"

namespace dampline::bus {

using Words = std::vector<std::string>;

/// What a run directory holds that the frames decide. Equal text means equal numbers, to the last
/// bit: they are written with as many digits as that takes.
struct RunFiles {
  std::string parameters;  ///< those of parameters.json
  std::string counts;      ///< likewise
  std::string state;       ///< state.dls
  std::string curve;       ///< curve.csv
  std::string convergence;
  bool operator==(const RunFiles&) const = default;
};
[[nodiscard]] RunFiles read_run(const std::filesystem::path& run);
[[nodiscard]] nlohmann::json read_parameters(const std::filesystem::path& run);
/// Of parameters.json. Throws when there is none of that name.
[[nodiscard]] double value_of(const nlohmann::json& parameters, const std::string& name);

/// `dampline identify INTERFACE` as a person starts it, in real-time scheduling.
class LiveProgram {
 public:
  /// Returns when it listens. `run` is its run directory.
  LiveProgram(const Folder& folder, const std::string& interface, std::filesystem::path run,
              const Words& options = {});
  /// Memory that it holds, by its name in /proc/PID/status, in KiB. Throws when it has ended.
  [[nodiscard]] std::uint64_t memory_kib(const std::string& name);
  void signal(int number) const noexcept { child_.signal(number); }
  [[nodiscard]] const std::filesystem::path& run() const noexcept { return run_; }
  /// Ends it by SIGINT. Throws when it does not end well; returns parameters.json.
  nlohmann::json stop();

 private:
  std::filesystem::path run_;
  Child child_;
};

/// `dampline identify RECORD` to its end. Throws when it fails.
void identify(const std::filesystem::path& record, const std::filesystem::path& run);

/// `dampline simulate --to`, in batches: each goes out whole before a reader looks, because one
/// wake-up of a reader costs more than many frames.
[[nodiscard]] Words simulate_command(const std::string& interface, double duration_s, int batch,
                                     const Words& options = {});

}  // namespace dampline::bus
