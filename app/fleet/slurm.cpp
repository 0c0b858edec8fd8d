// SPDX-License-Identifier: MIT
#include "app/fleet/slurm.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <memory>
#include <system_error>

#include "app/error.hpp"
#include "app/run/disk.hpp"
#include "app/run/provenance.hpp"

namespace dampline::app::fleet {
namespace {

namespace fs = std::filesystem;

/// For a shell: in single quotes.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string{"'\\''"} : std::string(1, c);
  return out + "'";
}

/// What a command of fixed words and quoted names prints.
std::string output_of(const std::string& command) {
  struct Close {
    void operator()(FILE* stream) const { ::pclose(stream); }
  };
  // NOLINTNEXTLINE(cert-env33-c): sbatch is found as its user's shell finds it; names are quoted
  std::unique_ptr<FILE, Close> pipe{::popen((command + " 2>&1").c_str(), "r")};
  if (!pipe) throw RunError{"sbatch: cannot be started"};
  std::string out;
  std::array<char, 256> text{};
  while (std::fgets(text.data(), text.size(), pipe.get()) != nullptr) out += text.data();
  const int status = ::pclose(pipe.release());
  while (!out.empty() && out.back() == '\n') out.pop_back();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw RunError{fmt::format("sbatch: {}", out)};
  return out.substr(0, out.find(';'));  // behind it, the cluster's name
}

/// `number`: sbatch's word for what tells the outputs apart.
std::string script(const std::string& name, const fs::path& folder, const char* number, int jobs,
                   const std::string& command) {
  return fmt::format(
      "#!/bin/sh\n#SBATCH --job-name={}\n#SBATCH --requeue\n#SBATCH --open-mode=append\n"
      "#SBATCH --cpus-per-task={}\n#SBATCH --output={}/%x.{}.out\nexec {}\n",
      name, jobs, folder.string(), number, command);
}

}  // namespace

SlurmJobs submit_slurm(const fs::path& out, const std::vector<Log>& logs, int tasks, int jobs,
                       const std::string& arguments) {
  const fs::path folder = fs::absolute(out) / "slurm";
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) fail_io(folder, "write into it", error.value());
  std::string list;
  for (const Log& log : logs) list += log.file.string() + "\n";
  write_file(folder / "logs.txt", list);
  const std::string command = fmt::format(
      "{} archive --list {} --out {} --jobs {} --quiet{}", quoted(program_file().string()),
      quoted((folder / "logs.txt").string()), quoted(fs::absolute(out).string()), jobs, arguments);
  write_file(folder / "task.sh",
             script("dampline-archive", folder, "%a", jobs,
                    fmt::format("{} --part \"$SLURM_ARRAY_TASK_ID/{}\"", command, tasks)));
  write_file(folder / "merge.sh",
             script("dampline-merge", folder, "%j", jobs, command + " --merge-only"));
  SlurmJobs submitted;
  submitted.array = output_of(fmt::format("sbatch --parsable --array=0-{} {}", tasks - 1,
                                          quoted((folder / "task.sh").string())));
  submitted.merge = output_of(fmt::format("sbatch --parsable --dependency=afterok:{} {}",
                                          submitted.array, quoted((folder / "merge.sh").string())));
  return submitted;
}

}  // namespace dampline::app::fleet
