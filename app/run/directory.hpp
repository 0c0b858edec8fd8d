// SPDX-License-Identifier: MIT
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/config/config.hpp"
#include "app/run/disk.hpp"
#include "app/run/provenance.hpp"
#include "app/run/result.hpp"
#include "app/run/state.hpp"
#include "app/run/swept.hpp"
#include "dampline/estimate/statistics.hpp"

namespace dampline::app {

/// Where a run writes its results. Files are staged out of sight and appear together at commit(),
/// in one exchange of names: whatever interrupts it, there is the earlier run or the new one,
/// whole. A directory without `run.toml` is not a run. When the object goes away uncommitted,
/// everything that it made goes too, also where a signal ends the program before anything is
/// staged; what a kill left of another is removed.
class RunDirectory {
 public:
  /// Makes the directory where it is missing, so that a place that cannot be written fails before
  /// the work. Throws UsageError when it holds something and `replace` is not set, or when it holds
  /// something that is not a run, or cannot be replaced in one step; IoError when it cannot be
  /// made.
  RunDirectory(std::filesystem::path target, bool replace);
  RunDirectory(const RunDirectory&) = delete;
  RunDirectory& operator=(const RunDirectory&) = delete;
  ~RunDirectory();

  /// Stages one file. Throws IoError when the disk is full or the file cannot be written.
  void write(const std::string& name, std::string_view content);
  void commit();

 private:
  void check_target(bool replace);
  void make_target();
  void make_staging();
  void change_names();
  void move_files();
  void remove_made() noexcept;

  std::filesystem::path shown_;   ///< as it was given
  std::filesystem::path target_;  ///< absolute, no link
  std::filesystem::path staging_;
  Descriptor lock_;       ///< of `staging_`
  bool replaces_{false};  ///< an earlier run
  bool beside_{false};    ///< `staging_` lies beside `target_`, not in it
  std::vector<std::filesystem::path>
      made_;  ///< directories that did not exist before, innermost first
  std::vector<std::string> names_;
  bool committed_{false};
  std::optional<SweptOnSignal> swept_;  ///< as long as nothing is staged
};

/// STEM.run, or STEM.run.N behind the highest number that exists in `folder`.
[[nodiscard]] std::filesystem::path free_run_name(const std::filesystem::path& folder,
                                                  const std::string& stem);

/// Removes the oldest runs of such names beyond `keep`, and nothing that is no run; gives which.
std::vector<std::filesystem::path> remove_old_runs(const std::filesystem::path& folder,
                                                   const std::string& stem, std::size_t keep);

/// What a run directory is made of beside report.html.
struct RunFiles {
  RunResult result;
  std::string run_toml;
  std::string state;       ///< state.dls; empty: there is none
  std::string segments{};  ///< segments.csv of a merge; empty: there is none
};

/// What the state of a truck's sums is of, as the result says: its origin is stated already.
[[nodiscard]] StateAbout state_about(const Config& config, const RunResult& result,
                                     const Statistics& sums);

/// Of a result and what it was made of: the result says where it comes from, run.toml repeats it,
/// and so does the state of a truck's sums. `inputs`: the source first. `sums`: null: there are
/// none.
[[nodiscard]] RunFiles make_files(const Config& config, RunResult result,
                                  const std::vector<InputFile>& inputs,
                                  const Statistics* sums = nullptr);

/// Stages everything. Throws RunError.
void stage_files(const RunFiles& files, RunDirectory& directory);

/// Reads a run back for its report; the state stays where it is. Throws RunError naming the file
/// that is missing or damaged.
[[nodiscard]] RunFiles read_files(const std::filesystem::path& run);

}  // namespace dampline::app
