// SPDX-License-Identifier: MIT
#include "app/rig/identify.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "app/config/config.hpp"
#include "app/diagnosis/rig/explain.hpp"
#include "app/diagnosis/truck/document.hpp"
#include "app/diagnosis/truck/explanation.hpp"
#include "app/error.hpp"
#include "app/identify/source.hpp"
#include "app/live/interface.hpp"
#include "app/record/columns.hpp"
#include "app/record/rate.hpp"
#include "app/report/page.hpp"
#include "app/rig/record.hpp"
#include "app/rig/result.hpp"
#include "app/run/directory.hpp"
#include "app/run/json.hpp"
#include "app/run/provenance.hpp"
#include "app/run/trust.hpp"
#include "app/text/format.hpp"
#include "app/text/summary.hpp"
#include "app/verbs/run_flags.hpp"
#include "app/verbs/verbs.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app {
namespace {

struct ExplainFlags : RunFlags {
  std::vector<std::string> records;
  std::vector<std::string> validation;
  std::string reference;
  bool skip_bad_lines{false};
  bool no_refine{false};
};

/// What a run directory and the terminal get.
struct Findings {
  std::string summary;
  RunFiles files;
};

Findings explain_truck_record(const Config& config, const ExplainFlags& options) {
  if (options.records.size() > 1)
    throw UsageError{
        fmt::format("RECORD: found {} records, expected one of a truck; others go with --validate",
                    options.records.size())};
  Explained found = explain_truck(config, {{options.records.front(), options.skip_bad_lines},
                                           options.validation,
                                           options.show_progress(),
                                           !options.no_refine});
  RunResult result = found.identified;
  const Explanation explanation = conclude(found, result);
  law::Document law =
      document_of(found, result.parameters, estimator_config(config).moving_mass_kg);
  law.record = options.records.front();
  result.law = to_json(law);
  return {summarize(explanation),
          make_files(config, std::move(result), found.inputs, found.sums.get())};
}

/// What a rig's explanation concludes into.
RunResult base_of_rig(const SourceOptions& source, const Config& config) {
  return rig::identify(rig::csv_record(source.path, config.input, source.skip_bad_lines), config);
}

Findings explain_rig_records(const Config& config, const ExplainFlags& options,
                             const std::vector<std::string>& notes) {
  rig::Explanation found =
      rig::explain(config, {options.records, options.validation, options.reference,
                            options.skip_bad_lines, !options.no_refine});
  found.notes.insert(found.notes.begin(), notes.begin(), notes.end());
  std::vector<InputFile> inputs;
  for (const std::string& path : options.records) inputs.push_back(describe_record(path));
  for (const std::string& path : options.validation)
    inputs.push_back(describe_input(path, "validation"));
  RunResult result = base_of_rig({options.records.front(), options.skip_bad_lines}, config);
  const Explanation explanation = rig::conclude(found, result);
  return {summarize(explanation), make_files(config, std::move(result), inputs)};
}

int explain(const ExplainFlags& options) {
  const std::filesystem::path place = options.place(options.records.front());
  RunDirectory directory{place, options.force};
  const SourceOptions first{options.records.front(), options.skip_bad_lines};
  const RecognisedColumns seen = recognise_columns(options.load(), first);
  const SourceKind kind = detect_source(seen.config, first);
  const Config config = with_record_rate(seen.config, first, kind);
  Findings found = kind == SourceKind::kRigRows ? explain_rig_records(config, options, seen.notes)
                                                : explain_truck_record(config, options);
  const RunResult& result = found.files.result;
  options.write(found.files, directory);
  if (options.json) {
    fmt::print("{}", result.evidence.explanation);
  } else if (!options.quiet) {
    fmt::print("{}{}: {}\n", drivers::printable(found.summary, true),
               options.no_report ? "results" : "report", options.outcome(place));
  }
  return options.verdict(result);
}

}  // namespace

void add_explain_verb(CLI::App& program, std::function<int()>& action) {
  CLI::App* verb = program.add_subcommand(
      "explain", "Find out what a model lacks: the effect, its size, the error before and after");
  const auto options = std::make_shared<ExplainFlags>();
  verb->add_option(
          "RECORD", options->records,
          "a truck's record of any format that identify reads, or a black box; or records of "
          "a rig in columns (CSV, NumPy, MAT, HDF5, MDF4), explained by one model")
      ->required();
  verb->add_option("--validate", options->validation,
                   "records that are never fitted, only predicted; after RECORD")
      ->expected(1, -1);
  verb->add_option("--reference-column", options->reference,
                   "a rig's validation: a column with another prediction of the force, in N");
  verb->add_option("--config", options->config,
                   "configuration (TOML): [model] base and candidates, [car], [input]");
  verb->add_option("--out", options->out,
                   "run directory; default: a new one named after the record");
  verb->add_flag("--force", options->force, "replace an earlier run in --out");
  verb->add_flag("--no-report", options->no_report, "do not draw report.html");
  verb->add_flag("--json", options->json, "print explanation.json instead of a table");
  verb->add_flag("--quiet", options->quiet, "print nothing but errors and warnings");
  verb->add_flag("--skip-bad-lines", options->skip_bad_lines,
                 "count malformed lines instead of stopping at the first");
  verb->add_flag("--no-refine", options->no_refine,
                 "leave the law of a driven mass, or a truck's spring, as the equations have it, "
                 "without its own motion");
  options->add_strict(*verb);
  verb->callback([options, &action] { action = [options] { return explain(*options); }; });
}

namespace {

struct IdentifyFlags : RunFlags {
  SourceOptions source;
  std::string methods;
  std::string method;  ///< of the program that main() becomes; here for the help only
  LiveOptions live;
  std::string blackbox;
  std::string live_file;
  std::string serve;
  std::string serve_token_file;
  std::string prom_file;
  bool no_blackbox{false};
  bool any_live_flag{false};
};

void print_result(const IdentifyFlags& options, const RunResult& result,
                  const std::filesystem::path& place) {
  if (options.json) fmt::print("{}", to_json(result));
  if (options.json || options.quiet) return;
  fmt::print("{}  {:<20} {}\n", drivers::printable(summarize(result), true),
             options.no_report ? "results" : "report", options.outcome(place));
}

void check_live_flags(const IdentifyFlags& options, SourceKind kind) {
  if (options.any_live_flag && kind != SourceKind::kInterface)
    throw UsageError{fmt::format(
        "{}: is a record; --duration, --publish-every, --live-file, --serve, --serve-token-file, "
        "--prom-file, --read-every, --blackbox, --no-blackbox and --realtime-priority are for an "
        "interface; `dampline replay` serves a record",
        options.source.path)};
  if (options.no_blackbox && !options.blackbox.empty())
    throw UsageError{"--blackbox and --no-blackbox exclude each other"};
}

std::filesystem::path blackbox_of(const IdentifyFlags& options,
                                  const std::filesystem::path& place) {
  if (options.no_blackbox) return {};
  return options.blackbox.empty() ? place / "blackbox" : std::filesystem::path{options.blackbox};
}

/// A rig whose base has effects with lengths and speeds of their own: the search finds them, and
/// looks for nothing else.
Identified identify_by_search(Config config, const IdentifyFlags& options) {
  config.model.candidates.clear();
  const SourceOptions& source = options.source;
  const rig::Explanation found =
      rig::explain(config, {{source.path}, {}, "", source.skip_bad_lines});
  Identified out;
  out.inputs = {describe_record(source.path)};
  out.result = base_of_rig(source, config);
  rig::conclude(found, out.result);
  return out;
}

/// A record, or a live interface until it ends.
Identified find(const IdentifyFlags& options, const Config& config, SourceKind kind,
                const std::filesystem::path& place) {
  const bool progress = options.show_progress();
  if (kind == SourceKind::kRigRows && !rig::searched_base(config.model).empty())
    return identify_by_search(config, options);
  if (kind != SourceKind::kInterface)
    return identify_source(config, options.source, kind, progress);
  return identify_live(
      config, options.source.path, options.live,
      {place, blackbox_of(options, place), options.live_file, options.prom_file, progress});
}

Config config_of(const IdentifyFlags& options) {
  Config config = options.load();
  if (!options.methods.empty()) config.estimate.methods = options.methods;
  if (!options.serve.empty()) config.serve.address = options.serve;
  if (!options.serve_token_file.empty()) config.serve.token_file = options.serve_token_file;
  return config;
}

/// Where a run is put whose own place cannot be written; the service manager's comes first.
std::vector<std::filesystem::path> refuges() {
  std::vector<std::filesystem::path> out;
  if (const char* runtime = std::getenv("RUNTIME_DIRECTORY"); runtime != nullptr)
    out.emplace_back(runtime);
  std::error_code error;
  if (auto temporary = std::filesystem::temp_directory_path(error); !error)
    out.push_back(std::move(temporary));
  out.emplace_back("/dev/shm");
  return out;
}

[[noreturn]] void take_refuge(const IdentifyFlags& options, const RunFiles& files,
                              const std::filesystem::path& place, const IoError& reason) {
  for (const std::filesystem::path& refuge : refuges()) {
    const std::string stem = "dampline-" + place.stem().string();
    const std::filesystem::path other = free_run_name(refuge, stem);
    try {
      RunDirectory directory{other, false};
      options.write(files, directory);
    } catch (const RunError&) {
      continue;
    } catch (const UsageError&) {
      continue;
    }
    throw RunError{fmt::format("{}; the run was put into {}", reason.what(), other.string())};
  }
  throw RunError{fmt::format("{}; no other place took the run, which is lost", reason.what())};
}

/// The result of a live run cannot be had again: it waits for space, then it goes elsewhere.
void write_patiently(const IdentifyFlags& options, const RunFiles& files,
                     std::optional<RunDirectory>& directory, const std::filesystem::path& place) {
  constexpr int kAttempts = 30;
  constexpr std::chrono::seconds kPause{1};
  for (int attempt = 1;; ++attempt) {
    try {
      if (!directory) directory.emplace(place, options.force);
      return options.write(files, *directory);
    } catch (const IoError& error) {
      directory.reset();
      if (attempt == 1)
        warn(fmt::format("{}; this is tried again for {} s", error.what(), kAttempts));
      if (attempt == kAttempts) take_refuge(options, files, place, error);
    }
    std::this_thread::sleep_for(kPause);
  }
}

void write_result(const IdentifyFlags& options, const RunFiles& files,
                  std::optional<RunDirectory>& directory, const std::filesystem::path& place,
                  SourceKind kind) {
  if (kind != SourceKind::kInterface) return options.write(files, *directory);
  write_patiently(options, files, directory, place);
}

/// A service makes a run at each start.
void remove_runs_before(const IdentifyFlags& options, const Config& config,
                        const std::filesystem::path& place) {
  if (!options.out.empty() || config.live.keep_runs == 0) return;
  const auto removed =
      remove_old_runs(place.parent_path(), std::filesystem::path{options.source.path}.stem(),
                      static_cast<std::size_t>(config.live.keep_runs));
  for (const std::filesystem::path& run : removed)
    if (!options.quiet) warn(fmt::format("{}: an old run, removed", run.string()));
}

int identify(const IdentifyFlags& options) {
  const RecognisedColumns seen = recognise_columns(config_of(options), options.source);
  const SourceKind kind = detect_source(seen.config, options.source);
  const Config config = with_record_rate(seen.config, options.source, kind);
  check_live_flags(options, kind);
  const std::filesystem::path place = options.place(options.source.path);
  std::optional<RunDirectory> directory;
  directory.emplace(place, options.force);  // first: a place that cannot be written costs no work
  if (kind == SourceKind::kInterface) remove_runs_before(options, config, place);
  Identified found = find(options, config, kind, place);
  found.result.notes.insert(found.result.notes.begin(), seen.notes.begin(), seen.notes.end());
  const RunFiles files =
      make_files(config, std::move(found.result), found.inputs, found.sums.get());
  write_result(options, files, directory, place, kind);
  print_result(options, files.result, place);
  return options.verdict(files.result);
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
        verb.add_option("--live-file", options.live_file,
                        "keep a copy of live.json at this path as well, the same for every run"),
        verb.add_option("--serve", options.serve,
                        "HOST:PORT of a live page, metrics and events: 127.0.0.1:9464"),
        verb.add_option("--serve-token-file", options.serve_token_file,
                        "file with the token of readers; an address beyond this machine needs it"),
        verb.add_option("--prom-file", options.prom_file,
                        "keep the metrics in this file as well, for node_exporter: NAME.prom"),
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
  verb->add_option(
          "SOURCE", options->source.path,
          "an interface (can0, vcan0), a file of frames (candump, ASC, BLF, TRC, MDF4) or "
          "rows (CSV, NumPy, MAT, HDF5, MDF4), a black box, or - for such a file on standard input")
      ->required();
  verb->add_option("--config", options->config,
                   "configuration (TOML); without it CSV files work by "
                   "their header and candump logs by the project's DBC");
  verb->add_option("--methods", options->methods,
                   "of a truck: wavelet, or all: Fokker-Planck, known input and phase beside it; "
                   "default: as configured, else wavelet")
      ->check(CLI::IsMember({"wavelet", "all"}));
  verb->add_option(
      "--method", options->method,
      "of a rig: wavelet, with --terms \"v, x, x^3, sign(v)\": terms of your choice by "
      "the rows of Ghanem and Romeo; its options: identify --method wavelet --help");
  verb->add_option("--out", options->out,
                   "run directory; default: a new one named after the source");
  verb->add_flag("--force", options->force, "replace an earlier run in --out");
  verb->add_flag("--json", options->json, "print parameters.json instead of a table");
  verb->add_flag("--quiet", options->quiet, "print nothing but errors and warnings");
  verb->add_flag("--skip-bad-lines", options->source.skip_bad_lines,
                 "count malformed lines instead of stopping at the first");
  verb->add_flag("--no-report", options->no_report, "do not draw report.html");
  options->add_strict(*verb);
  add_live_flags(*verb, *options);
  verb->callback([options, &action] { action = [options] { return identify(*options); }; });
}

}  // namespace dampline::app
