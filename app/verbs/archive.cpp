// SPDX-License-Identifier: MIT
#include "app/verbs/archive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>

#include "app/error.hpp"
#include "app/fleet/merged.hpp"
#include "app/fleet/slurm.hpp"
#include "app/run/json.hpp"
#include "app/verbs/verbs.hpp"

namespace dampline::app {
namespace {

std::vector<std::string> sources_of(const ArchiveFlags& flags) {
  if (flags.list.empty() == flags.logs.empty())
    throw UsageError{"LOG: found none or both of logs and --list, expected one of them"};
  if (flags.list.empty()) return flags.logs;
  std::ifstream stream{flags.list};
  if (!stream) throw RunError{fmt::format("{}: cannot be read", flags.list)};
  std::vector<std::string> out;
  for (std::string line; std::getline(stream, line);)
    if (!line.empty()) out.push_back(line);
  return out;
}

/// "2/7": the third of seven.
fleet::Part part_of(const std::string& text) {
  fleet::Part part;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, part.part);
  const bool slash = first.ec == std::errc{} && first.ptr != end && *first.ptr == '/';
  const auto second = slash ? std::from_chars(first.ptr + 1, end, part.of) : first;
  if (!slash || second.ec != std::errc{} || second.ptr != end || part.part >= part.of)
    throw UsageError{fmt::format("--part: found {}, expected I/N: part number I, from 0 on, of N",
                                 drivers::quote(text))};
  return part;
}

fleet::ArchiveOptions options_of(const ArchiveFlags& flags) {
  return {flags.load(),
          fleet::parse_folders(flags.folders),
          flags.out,
          fleet::jobs_or_all(flags.jobs),
          flags.skip_bad_lines,
          flags.show_progress()};
}

/// What is said at the end.
struct Outcome {
  fleet::Tally tally;
  std::vector<fleet::Archive::SetAside> set_aside;
  std::vector<fleet::LeftOut> left_out;
  std::optional<RunResult> result;
  std::string run;
};

void merge_all(const ArchiveFlags& flags, const fleet::Archive& archive, fleet::Workers& workers,
               Outcome& out) {
  fleet::Leaves found = fleet::find_leaves({archive.states().string()});
  const std::vector<fleet::Leaf> leaves =
      fleet::check_alike(std::move(found.list), flags.leave_out ? &found.left_out : nullptr);
  const fleet::Merged merged =
      fleet::merge_alike(leaves, workers.chunks(leaves, fleet::jobs_or_all(flags.jobs)));
  RunFiles files = fleet::files_of(merged, leaves, {archive.states().string()}, found.notes);
  RunDirectory directory{archive.merged(), true};
  flags.write(files, directory);
  out.left_out = std::move(found.left_out);
  out.result = std::move(files.result);
  out.run = archive.merged().string();
}

std::string to_json(const Outcome& outcome) {
  using Json = nlohmann::ordered_json;
  Json aside = Json::array();
  for (const auto& log : outcome.set_aside)
    aside.push_back({{"log", log.log}, {"reason", log.reason}});
  const fleet::Tally& t = outcome.tally;
  return json_text({{"schema", "dampline.archive/1"},
                    {"logs", t.logs},
                    {"states_made", t.made},
                    {"done_before", t.before},
                    {"bytes_read", t.bytes},
                    {"duration_s", t.seconds},
                    {"set_aside", aside},
                    {"left_out", fleet::to_json(outcome.left_out)},
                    {"run", outcome.run.empty() ? Json{nullptr} : Json(outcome.run)}});
}

void print_outcome(const ArchiveFlags& flags, const Outcome& outcome) {
  if (flags.json) fmt::print("{}", to_json(outcome));
  if (flags.json || flags.quiet) return;
  constexpr double kMega = 1e6;
  const fleet::Tally& t = outcome.tally;
  std::string text = fmt::format("{} logs: {} states made, {} done before, {} set aside", t.logs,
                                 t.made, t.before, t.set_aside);
  if (t.bytes > 0)
    text +=
        fmt::format("; {:.1f} MB in {:.2f} s, {:.1f} MB/s", static_cast<double>(t.bytes) / kMega,
                    t.seconds, static_cast<double>(t.bytes) / kMega / std::max(t.seconds, 1e-9));
  text += "\n";
  for (const auto& log : outcome.set_aside) text += fmt::format("set aside: {}\n", log.reason);
  for (const fleet::LeftOut& state : outcome.left_out)
    text += fmt::format("left out: {}: {}\n", state.file.string(), state.reason);
  if (outcome.result)
    text += fmt::format("{}\n{}: {}\n", outcome.result->headline,
                        flags.no_report ? "results" : "report", flags.outcome(outcome.run));
  fmt::print("{}", drivers::printable(text, true));
}

int submit(const ArchiveFlags& flags, const fleet::Archive& archive,
           const std::vector<fleet::Log>& logs) {
  std::vector<std::string> more;
  if (!flags.config.empty())
    more.insert(more.end(), {"--config", std::filesystem::absolute(flags.config).string()});
  if (!flags.folders.empty()) more.insert(more.end(), {"--folders", flags.folders});
  for (const auto& [set, name] : {std::pair{flags.leave_out, "--leave-out"},
                                  std::pair{flags.skip_bad_lines, "--skip-bad-lines"},
                                  std::pair{flags.no_report, "--no-report"}})
    if (set) more.emplace_back(name);
  const fleet::SlurmJobs jobs =
      fleet::submit_slurm(flags.out, logs, flags.slurm, std::max(flags.jobs, 1), more);
  fmt::print("{} logs in {} tasks: job {}; merge behind it: job {}; results: {}\n", logs.size(),
             flags.slurm, jobs.array, jobs.merge, archive.merged().string());
  return 0;
}

}  // namespace

int archive(const ArchiveFlags& flags, fleet::Workers& workers) {
  if (flags.merge_only && !flags.part.empty())
    throw UsageError{"--part and --merge-only exclude each other"};
  const std::vector<fleet::Log> logs = fleet::find_logs(sources_of(flags));
  const fleet::Archive archive{options_of(flags)};
  if (flags.again) archive.try_again(logs);
  if (flags.slurm > 0) return submit(flags, archive, logs);
  const fleet::Part part = flags.part.empty() ? workers.part() : part_of(flags.part);
  Outcome outcome;
  if (!flags.merge_only) outcome.tally = workers.gather(archive.run(logs, part));
  if (!workers.is_first()) {
    if (flags.part.empty()) workers.help();
    return 0;
  }
  outcome.set_aside = archive.set_aside();
  if (flags.part.empty()) merge_all(flags, archive, workers, outcome);
  print_outcome(flags, outcome);
  return outcome.result ? flags.verdict(*outcome.result) : 0;
}

void add_archive_options(CLI::App& verb, ArchiveFlags& flags) {
  verb.add_option("LOG", flags.logs,
                  "trucks' records of any format that identify reads, or directories of them");
  verb.add_option("--list", flags.list, "a file with a log in each line, instead of LOG");
  verb.add_option("--out", flags.out,
                  "the archive: states/, set_aside/ and, of all states in it, the run directory "
                  "merged/; what is there is not made again")
      ->required();
  verb.add_option("--config", flags.config, "configuration (TOML), the same for all logs");
  verb.add_option("--folders", flags.folders,
                  "what the names of a log's folders are, from the outermost on: vehicle/truck");
  verb.add_option("--jobs", flags.jobs, "threads; default: as the machine has processors")
      ->check(CLI::Range(1, 1024));
  verb.add_option("--part", flags.part, "I/N: this process makes the states of part I of N alone");
  verb.add_flag("--merge-only", flags.merge_only, "merge what is there");
  verb.add_option("--slurm", flags.slurm,
                  "submit to Slurm: an array of that many tasks, and a merge behind it")
      ->check(CLI::Range(1, 100000));
  verb.add_flag("--leave-out", flags.leave_out,
                "leave out, and list, states that cannot be added instead of ending");
  verb.add_flag("--again", flags.again, "try again the logs that were set aside");
  verb.add_flag("--skip-bad-lines", flags.skip_bad_lines,
                "count malformed lines instead of setting the log aside");
  verb.add_flag("--json", flags.json, "print what was done as JSON");
  verb.add_flag("--quiet", flags.quiet, "print nothing but errors and warnings");
  verb.add_flag("--no-report", flags.no_report, "do not draw report.html");
  flags.add_strict(verb);
}

void add_archive_verb(CLI::App& program, std::function<int()>& action) {
  CLI::App* verb = program.add_subcommand(
      "archive", "Many logs into states and one merged run: by threads, under mpirun, or on Slurm");
  const auto flags = std::make_shared<ArchiveFlags>();
  add_archive_options(*verb, *flags);
  verb->callback([flags, &action] {
    action = [flags] {
      fleet::Workers alone;
      return archive(*flags, alone);
    };
  });
}

}  // namespace dampline::app
