// SPDX-License-Identifier: MIT
#include "app/verbs/identify.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "app/config/config.hpp"
#include "app/error.hpp"
#include "app/identify/identify_source.hpp"
#include "app/identify/recognised_columns.hpp"
#include "app/identify/record_rate.hpp"
#include "app/live/identify_live.hpp"
#include "app/report/stage_report.hpp"
#include "app/run/directory.hpp"
#include "app/run/files.hpp"
#include "app/run/parameters_json.hpp"
#include "app/run/run_toml.hpp"
#include "app/text/summary.hpp"

namespace dampline::app {
namespace {

struct IdentifyFlags {
  SourceOptions source;
  std::string config;
  std::string methods;
  std::string out;
  bool json{false};
  bool quiet{false};
  bool force{false};
  bool no_report{false};
  LiveOptions live;
  std::string blackbox;
  bool no_blackbox{false};
  bool any_live_flag{false};
};

std::filesystem::path place_of(const IdentifyFlags& options) {
  if (!options.out.empty()) return options.out;
  const std::string stem = options.source.path == "-"
                               ? "stdin"
                               : std::filesystem::path{options.source.path}.stem().string();
  return free_run_name(std::filesystem::current_path(), stem);
}

void print_result(const IdentifyFlags& options, const RunResult& result,
                  const std::filesystem::path& place) {
  if (options.json) fmt::print("{}", to_json(result));
  if (options.json || options.quiet) return;
  fmt::print("{}  {:<20} {}\n", summarize(result), options.no_report ? "results" : "report",
             (options.no_report ? place : place / "report.html").string());
}

void check_live_flags(const IdentifyFlags& options, SourceKind kind) {
  if (options.any_live_flag && kind != SourceKind::kInterface)
    throw UsageError{fmt::format(
        "{}: is a record; --duration, --publish-every, --read-every, --blackbox, --no-blackbox and "
        "--realtime-priority are for an interface",
        options.source.path)};
  if (options.no_blackbox && !options.blackbox.empty())
    throw UsageError{"--blackbox and --no-blackbox exclude each other"};
}

std::filesystem::path blackbox_of(const IdentifyFlags& options,
                                  const std::filesystem::path& place) {
  if (options.no_blackbox) return {};
  return options.blackbox.empty() ? place / "blackbox" : std::filesystem::path{options.blackbox};
}

/// A record, or a live interface until it ends.
Identified find(const IdentifyFlags& options, const Config& config, SourceKind kind,
                const std::filesystem::path& place) {
  const bool progress = !options.quiet && ::isatty(STDERR_FILENO) == 1;
  if (kind != SourceKind::kInterface)
    return identify_source(config, options.source, kind, progress);
  return identify_live(config, options.source.path, options.live,
                       {place, blackbox_of(options, place), progress});
}

Config config_of(const IdentifyFlags& options) {
  Config config = options.config.empty() ? Config{} : load_config(options.config);
  if (!options.methods.empty()) config.estimate.methods = options.methods;
  return config;
}

int identify(const IdentifyFlags& options) {
  const RecognisedColumns seen = recognise_columns(config_of(options), options.source);
  const SourceKind kind = detect_source(seen.config, options.source);
  const Config config = with_record_rate(seen.config, options.source, kind);
  check_live_flags(options, kind);
  const std::filesystem::path place = place_of(options);
  RunDirectory directory{place,
                         options.force};  // first: a place that cannot be written costs no work
  Identified found = find(options, config, kind, place);
  found.result.notes.insert(found.result.notes.begin(), seen.notes.begin(), seen.notes.end());
  const RunFiles files{std::move(found.result), write_run_toml(config, found.inputs),
                       std::move(found.state)};
  stage_files(files, directory);
  if (!options.no_report) stage_report(files, directory);
  directory.commit();
  print_result(options, files.result, place);
  return 0;
}

void add_live_flags(CLI::App& verb, IdentifyFlags& options) {
  constexpr double kHundredYearsS = 3.2e9;
  LiveOptions& live = options.live;
  const std::string group = "Live (SOURCE is an interface)";
  for (CLI::Option* option :
       {verb.add_option("--duration", live.duration_s, "end after this time in s; 0: on a signal")
            ->check(CLI::Range(0.0, kHundredYearsS)),
        verb.add_option("--publish-every", live.publish_every_s,
                        "s between two versions of live.json")
            ->check(CLI::Range(0.1, kHundredYearsS))
            ->capture_default_str(),
        verb.add_option("--read-every", live.read_every_s,
                        "s between two looks at the bus: fewer wake-ups, later results; 0: as "
                        "frames arrive")
            ->check(CLI::Range(0.0, 1.0))
            ->capture_default_str(),
        verb.add_option("--blackbox", options.blackbox,
                        "record frames and events here; default: blackbox in the run directory"),
        verb.add_flag("--no-blackbox", options.no_blackbox, "record nothing"),
        verb.add_option("--realtime-priority", live.realtime_priority,
                        "SCHED_FIFO priority of the acquisition, 1 to 99; 0: ordinary scheduling")
            ->check(CLI::Range(0, 99))
            ->capture_default_str()})
    option->group(group)->each([&options](const std::string&) { options.any_live_flag = true; });
}

}  // namespace

void add_identify_verb(CLI::App& program, std::function<int()>& action) {
  CLI::App* verb = program.add_subcommand(
      "identify",
      "Turn a recorded run, or a live CAN bus, into a damping curve with its "
      "uncertainty");
  const auto options = std::make_shared<IdentifyFlags>();
  verb->add_option("SOURCE", options->source.path,
                   "an interface (can0, vcan0), FILE.log (candump), FILE.csv, a black box, or - "
                   "for candump text on standard input")
      ->required();
  verb->add_option("--config", options->config,
                   "configuration (TOML); without it CSV files work by "
                   "their header and candump logs by the project's DBC");
  verb->add_option("--methods", options->methods,
                   "of a truck: wavelet, or all: Fokker-Planck, known input and phase beside it; "
                   "default: as configured, else wavelet")
      ->check(CLI::IsMember({"wavelet", "all"}));
  verb->add_option("--out", options->out,
                   "run directory; default: a new one named after the source");
  verb->add_flag("--force", options->force, "replace an earlier run in --out");
  verb->add_flag("--json", options->json, "print parameters.json instead of a table");
  verb->add_flag("--quiet", options->quiet, "print nothing but errors and warnings");
  verb->add_flag("--skip-bad-lines", options->source.skip_bad_lines,
                 "count malformed lines instead of stopping at the first");
  verb->add_flag("--no-report", options->no_report, "do not draw report.html");
  add_live_flags(*verb, *options);
  verb->callback([options, &action] { action = [options] { return identify(*options); }; });
}

}  // namespace dampline::app
