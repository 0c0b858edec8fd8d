// SPDX-License-Identifier: MIT
// How fast a recorded run is replayed, decoding included, and how much memory that takes, beside
// canplayer, which only parses the log, and beside NumPy doing a small part of the job and the
// whole of it. `replay PROGRAM [--day] [--json FILE]`: PROGRAM is the built dampline; --day adds 24
// hours through a pipe.
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace {

namespace fs = std::filesystem;

struct Usage {
  double cpu_s{0.0};
  double peak_mib{0.0};
  bool ok{false};
};

double seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

/// Runs a shell command and returns what it used; `exec` in the command makes it one process.
Usage run(const std::string& command) {
  const pid_t child = fork();
  if (child == 0) {
    execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  int status = 0;
  rusage usage{};
  if (wait4(child, &status, 0, &usage) != child) return {};
  return {.cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime),
          .peak_mib = static_cast<double>(usage.ru_maxrss) / 1024.0,
          .ok = WIFEXITED(status) && WEXITSTATUS(status) == 0};
}

constexpr double kFramesPerSecond = 900.0;  // of the record

/// On the standard output and in `out`.
void report(const std::string& name, double record_s, const Usage& usage, nlohmann::json& out) {
  if (!usage.ok) return fmt::print("| {} | skipped: it did not run here | | | |\n", name);
  out["replay"].push_back({{"name", name},
                           {"cpu_s", usage.cpu_s},
                           {"frames_per_s", kFramesPerSecond * record_s / usage.cpu_s},
                           {"peak_mib", usage.peak_mib}});
  fmt::print("| {} | {:.2f} | {:.0f} | {:.2f} | {:.1f} |\n", name, usage.cpu_s,
             record_s / usage.cpu_s, 1e-6 * kFramesPerSecond * record_s / usage.cpu_s,
             usage.peak_mib);
  std::fflush(stdout);
}

struct Contestant {
  std::string name;
  std::string command;
  Usage best{};
};

/// Everybody three times, one after the other, so that a slow moment of the machine meets all; the
/// least time of each counts.
void race(std::vector<Contestant>& contestants) {
  for (int round = 0; round < 3; ++round) {
    for (Contestant& each : contestants) {
      const Usage used = run(each.command);
      if (round == 0 || (used.ok && used.cpu_s < each.best.cpu_s)) each.best = used;
    }
  }
}

/// Writes a record with its configuration, and identifies it from the file.
void replay_file(const std::string& program, const fs::path& folder, int minutes,
                 nlohmann::json& out) {
  const std::string log = (folder / fmt::format("run{}.log", minutes)).string();
  const std::string config = (folder / "run.toml").string();
  const std::string dbc = (folder / "sensors.dbc").string();
  const std::string place = (folder / fmt::format("run{}", minutes)).string();
  const Usage made = run(fmt::format(
      "exec '{}' simulate --quiet --force --duration {} --out '{}' --dbc '{}' --config-out '{}'",
      program, 60 * minutes, log, dbc, config));
  if (!made.ok) return fmt::print("could not simulate with {}\n", program);
  const auto canplayer = [&](const char* to) {
    return fmt::format("LD_PRELOAD='{}' exec canplayer -t -I '{}' {}=can0 >/dev/null",
                       DAMPLINE_CAN_SOCKET, log, to);
  };
  const auto part = [&](const char* which) {
    return fmt::format("exec '{}' {} '{}' '{}' >/dev/null", DAMPLINE_PIPELINE, which, log, config);
  };
  const auto numpy = [&](const char* script) {
    return fmt::format("exec /usr/bin/python3 bench/peers/{} '{}' >/dev/null", script, log);
  };
  std::vector<Contestant> contestants{
      {"canplayer to a socket that takes all at once", canplayer("can0")},
      {"canplayer to stdout", canplayer("stdout")},
      {"dampline, lines to frames alone", part("frames")},
      {"dampline, lines to samples alone", part("samples")},
      {"small job, NumPy and SciPy", numpy("pipeline.py")},
      {"small job, dampline's classes", part("job")},
      {"whole job, NumPy and SciPy", numpy("whole_job.py")},
      {"dampline identify",
       fmt::format("exec '{}' identify --quiet --no-report --force --config '{}' --out '{}' '{}' "
                   ">/dev/null",
                   program, config, place, log)}};
  race(contestants);
  for (const Contestant& each : contestants)
    report(fmt::format("{} min, {}", minutes, each.name), 60.0 * minutes, each.best, out);
}

/// A day, from the simulator's pipe: no file of that size, and only identify is measured.
void replay_day(const std::string& program, const fs::path& folder, nlohmann::json& out) {
  const std::string pipe = (folder / "pipe").string();
  const Usage used =
      run(fmt::format("mkfifo '{0}'; '{1}' simulate --quiet --duration 86400 --format candump "
                      "--out '{0}' & exec '{1}' identify --quiet "
                      "--no-report --config '{2}' --out '{3}' - <'{0}' >/dev/null",
                      pipe, program, (folder / "run.toml").string(), (folder / "day").string()));
  report("24 h, candump pipe, dampline identify", 86400.0, used, out);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print("usage: replay PROGRAM [--day] [--json FILE]\n");
    return 2;
  }
  const std::string program = argv[1];
  std::string pattern = (fs::temp_directory_path() / "dampline-replay-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) return 1;
  const fs::path folder = pattern;
  fmt::print(
      "| record | CPU time in s | times real time | million frames a CPU second | peak memory in "
      "MiB |\n|--|--|--|--|--|\n");
  nlohmann::json out;
  replay_file(program, folder, 5, out);
  replay_file(program, folder, 20, out);
  for (int i = 2; i < argc; ++i) {
    if (std::string_view{argv[i]} == "--day") replay_day(program, folder, out);
    if (std::string_view{argv[i]} == "--json" && i + 1 < argc)
      std::ofstream{argv[i + 1]} << out.dump(2) << '\n';
  }
  fs::remove_all(folder);
  return EXIT_SUCCESS;
}
