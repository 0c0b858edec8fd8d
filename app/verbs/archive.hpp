// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <vector>

#include "app/fleet/workers.hpp"
#include "app/verbs/run_flags.hpp"

namespace dampline::app {

/// Of `dampline archive`, in one process and in many.
struct ArchiveFlags : RunFlags {
  std::vector<std::string> logs;
  std::string list;
  std::string folders;
  std::string part;
  int slurm{0};
  int jobs{0};
  bool merge_only{false};
  bool leave_out{false};
  bool again{false};
  bool skip_bad_lines{false};
};

void add_archive_options(CLI::App& verb, ArchiveFlags& flags);

/// The exit code. Throws RunError or UsageError.
int archive(const ArchiveFlags& flags, fleet::Workers& workers);

}  // namespace dampline::app
