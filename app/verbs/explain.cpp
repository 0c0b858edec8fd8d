// SPDX-License-Identifier: MIT
#include "app/verbs/explain.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/diagnosis/rig/explain.hpp"
#include "app/error.hpp"
#include "app/explain/explain_truck.hpp"
#include "app/explain/explanation_json.hpp"
#include "app/identify/recognised_columns.hpp"
#include "app/identify/record_rate.hpp"
#include "app/report/stage_report.hpp"
#include "app/rig/identify.hpp"
#include "app/rig/record.hpp"
#include "app/run/directory.hpp"
#include "app/run/files.hpp"
#include "app/run/run_toml.hpp"

namespace dampline::app {
namespace {

struct ExplainFlags {
  std::vector<std::string> records;
  std::vector<std::string> validation;
  std::string reference;
  bool skip_bad_lines{false};
  std::string config;
  std::string out;
  bool json{false};
  bool quiet{false};
  bool force{false};
  bool no_report{false};
};

std::filesystem::path place_of(const ExplainFlags& options) {
  if (!options.out.empty()) return options.out;
  const std::string& path = options.records.front();
  const std::string stem = path == "-" ? "stdin" : std::filesystem::path{path}.stem().string();
  return free_run_name(std::filesystem::current_path(), stem);
}

/// What a run directory and the terminal get.
struct Findings {
  std::string json;
  std::string summary;
  RunFiles files;
};

Findings explain_truck_record(const Config& config, const ExplainFlags& options,
                              bool show_progress) {
  if (options.records.size() > 1)
    throw UsageError{
        fmt::format("RECORD: found {} records, expected one of a truck; others go with --validate",
                    options.records.size())};
  const Explained found = explain_truck(
      config,
      {{options.records.front(), options.skip_bad_lines}, options.validation, show_progress});
  return {to_json(found),
          summarize(found),
          {found.identified, write_run_toml(config, found.inputs), found.state}};
}

Findings explain_rig_records(const Config& config, const ExplainFlags& options,
                             const std::vector<std::string>& notes) {
  rig::Explanation found = rig::explain(
      config, {options.records, options.validation, options.reference, options.skip_bad_lines});
  found.notes.insert(found.notes.begin(), notes.begin(), notes.end());
  std::vector<InputFile> inputs;
  for (const std::string& path : options.records) inputs.push_back(describe_input(path, "record"));
  for (const std::string& path : options.validation)
    inputs.push_back(describe_input(path, "validation"));
  RunResult first = rig::identify(
      rig::csv_record(options.records.front(), config.input, options.skip_bad_lines), config);
  first.evidence = found.evidence;
  first.notes.insert(first.notes.end(), found.notes.begin(), found.notes.end());
  return {to_json(found), summarize(found), {first, write_run_toml(config, inputs), ""}};
}

int explain(const ExplainFlags& options) {
  const std::filesystem::path place = place_of(options);
  RunDirectory directory{place, options.force};
  const SourceOptions first{options.records.front(), options.skip_bad_lines};
  const RecognisedColumns seen =
      recognise_columns(options.config.empty() ? Config{} : load_config(options.config), first);
  const SourceKind kind = detect_source(seen.config, first);
  const Config config = with_record_rate(seen.config, first, kind);
  const bool show_progress = !options.quiet && ::isatty(STDERR_FILENO) == 1;
  Findings found = kind == SourceKind::kRigCsv
                       ? explain_rig_records(config, options, seen.notes)
                       : explain_truck_record(config, options, show_progress);
  found.files.result.evidence.explanation = found.json;
  stage_files(found.files, directory);
  if (!options.no_report) stage_report(found.files, directory);
  directory.commit();
  if (options.json) {
    fmt::print("{}", found.json);
  } else if (!options.quiet) {
    fmt::print("{}{}: {}\n", found.summary, options.no_report ? "results" : "report",
               (options.no_report ? place : place / "report.html").string());
  }
  return 0;
}

}  // namespace

void add_explain_verb(CLI::App& program, std::function<int()>& action) {
  CLI::App* verb = program.add_subcommand(
      "explain", "Find out what a model lacks: the effect, its size, the error before and after");
  const auto options = std::make_shared<ExplainFlags>();
  verb->add_option(
          "RECORD", options->records,
          "a truck's record: FILE.log (candump), FILE.csv, or a black box; or records of a "
          "rig (FILE.csv), explained by one model")
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
  verb->callback([options, &action] { action = [options] { return explain(*options); }; });
}

}  // namespace dampline::app
