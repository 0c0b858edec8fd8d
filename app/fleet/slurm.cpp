// SPDX-License-Identifier: MIT
#include "app/fleet/slurm.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <sstream>
#include <system_error>
#include <vector>

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

/// Where the user's shell would find it.
fs::path find_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders{path == nullptr ? "/usr/bin" : path};
  for (std::string folder; std::getline(folders, folder, ':');)
    if (fs::path file = fs::path{folder} / name; ::access(file.c_str(), X_OK) == 0) return file;
  throw RunError{fmt::format("{}: is in no folder of PATH; Slurm brings it", name)};
}

std::string read_all(int from) {
  std::string out;
  std::array<char, 4096> bytes{};
  for (ssize_t count = ::read(from, bytes.data(), bytes.size()); count > 0;
       count = ::read(from, bytes.data(), bytes.size()))
    out.append(bytes.data(), static_cast<std::size_t>(count));
  return out;
}

/// What a program prints, on both outputs. No shell is asked. Throws RunError where it fails.
std::string output_of(std::vector<std::string> words) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) fail_io(words.front(), "be started", errno);
  const Descriptor from{ends[0]};
  Descriptor to{ends[1]};
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, to.get(), STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, to.get(), STDERR_FILENO);
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const fs::path program = find_program(words.front());
  pid_t child = 0;
  const int error =
      ::posix_spawn(&child, program.c_str(), &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  to.close();
  if (error != 0) fail_io(program, "be started", error);
  std::string out = read_all(from.get());
  int status = 0;
  ::waitpid(child, &status, 0);
  while (!out.empty() && out.back() == '\n') out.pop_back();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw RunError{fmt::format("{}: {}", words.front(), out)};
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
                       const std::vector<std::string>& arguments) {
  const fs::path folder = fs::absolute(out) / "slurm";
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) fail_io(folder, "write into it", error.value());
  std::string list;
  for (const Log& log : logs) list += log.file.string() + "\n";
  write_file(folder / "logs.txt", list);
  std::string command = fmt::format(
      "{} archive --list {} --out {} --jobs {} --quiet", quoted(program_file().string()),
      quoted((folder / "logs.txt").string()), quoted(fs::absolute(out).string()), jobs);
  for (const std::string& argument : arguments) command += fmt::format(" {}", quoted(argument));
  write_file(folder / "task.sh",
             script("dampline-archive", folder, "%a", jobs,
                    fmt::format("{} --part \"$SLURM_ARRAY_TASK_ID/{}\"", command, tasks)));
  write_file(folder / "merge.sh",
             script("dampline-merge", folder, "%j", jobs, command + " --merge-only"));
  SlurmJobs submitted;
  submitted.array = output_of({"sbatch", "--parsable", fmt::format("--array=0-{}", tasks - 1),
                               (folder / "task.sh").string()});
  submitted.merge =
      output_of({"sbatch", "--parsable", fmt::format("--dependency=afterok:{}", submitted.array),
                 (folder / "merge.sh").string()});
  return submitted;
}

}  // namespace dampline::app::fleet
