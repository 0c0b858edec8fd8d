// SPDX-License-Identifier: MIT
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "app/fleet/archive.hpp"

namespace dampline::app::fleet {

/// The jobs of one archive: an array of tasks, and behind it the merge.
struct SlurmJobs {
  std::string array;
  std::string merge;
};

/// Writes OUT/slurm/logs.txt, task.sh and merge.sh, and hands both scripts to sbatch; what it takes
/// from its environment (SBATCH_PARTITION, SBATCH_ACCOUNT, ...) holds. `arguments` are those of
/// `dampline archive` beside the logs, --out and --part. Throws RunError with sbatch's words.
[[nodiscard]] SlurmJobs submit_slurm(const std::filesystem::path& out, const std::vector<Log>& logs,
                                     int tasks, int jobs,
                                     const std::vector<std::string>& arguments);

}  // namespace dampline::app::fleet
