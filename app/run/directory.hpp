// SPDX-License-Identifier: MIT
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "app/config/config.hpp"
#include "app/run/provenance.hpp"
#include "app/run/result.hpp"

namespace dampline::app {

/// Writes a file so that a reader sees the old content or the whole new content, and so that the
/// new one survives a power cut. Throws RunError naming the file and the reason; leaves no partial
/// file.
void write_file(const std::filesystem::path& file, std::string_view content);

/// Where a run writes its results. Files are staged out of sight and appear together at commit(),
/// `run.toml` last: a directory without it is not a run. When the object goes away uncommitted,
/// everything that it made goes too.
class RunDirectory {
 public:
  /// Makes the directory where it is missing, so that a place that cannot be written fails before
  /// the work. Throws UsageError when it holds something and `replace` is not set, or when it holds
  /// something that is not a run; RunError when it cannot be made.
  RunDirectory(std::filesystem::path target, bool replace);
  RunDirectory(const RunDirectory&) = delete;
  RunDirectory& operator=(const RunDirectory&) = delete;
  ~RunDirectory();

  /// Stages one file. Throws RunError when the disk is full or the file cannot be written.
  void write(const std::string& name, std::string_view content);
  /// Where a staged file lies until commit().
  [[nodiscard]] std::filesystem::path staging() const { return staging_; }
  void commit();

 private:
  void make_target();
  void check_target(bool replace) const;
  void remove_made() noexcept;

  std::filesystem::path target_;
  std::filesystem::path staging_;
  std::vector<std::filesystem::path>
      made_;  ///< directories that did not exist before, innermost first
  std::vector<std::string> names_;
  bool committed_{false};
};

/// The first of STEM.run, STEM.run.2, STEM.run.3... in `folder` that does not exist.
[[nodiscard]] std::filesystem::path free_run_name(const std::filesystem::path& folder,
                                                  const std::string& stem);

/// What a run directory is made of beside report.html.
struct RunFiles {
  RunResult result;
  std::string run_toml;
  std::string state;  ///< state.dls; empty: there is none
};

/// Stages everything. Throws RunError.
void stage_files(const RunFiles& files, RunDirectory& directory);

/// Reads a run back for its report; the state stays where it is. Throws RunError naming the file
/// that is missing or damaged.
[[nodiscard]] RunFiles read_files(const std::filesystem::path& run);

}  // namespace dampline::app
