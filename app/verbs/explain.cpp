// SPDX-License-Identifier: MIT
#include "app/verbs/explain.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>

#include "app/config/config.hpp"
#include "app/explain/explain_truck.hpp"
#include "app/explain/explanation_json.hpp"
#include "app/run/directory.hpp"
#include "app/run/files.hpp"
#include "app/run/run_toml.hpp"

namespace dampline::app {
namespace {

struct Options {
  ExplainOptions explain;
  std::string config;
  std::string out;
  bool json{false};
  bool quiet{false};
  bool force{false};
};

std::filesystem::path place_of(const Options& options) {
  if (!options.out.empty()) return options.out;
  const std::string& path = options.explain.source.path;
  const std::string stem = path == "-" ? "stdin" : std::filesystem::path{path}.stem().string();
  return free_run_name(std::filesystem::current_path(), stem);
}

int explain(const Options& options) {
  const Config config = options.config.empty() ? Config{} : load_config(options.config);
  const std::filesystem::path place = place_of(options);
  RunDirectory directory{place, options.force};
  ExplainOptions wanted = options.explain;
  wanted.show_progress = !options.quiet && ::isatty(STDERR_FILENO) == 1;
  const Explained found = explain_truck(config, wanted);
  directory.write("explanation.json", to_json(found));
  stage_files({found.identified, write_run_toml(config, found.inputs), found.state}, directory);
  directory.commit();
  if (options.json) {
    fmt::print("{}", to_json(found));
  } else if (!options.quiet) {
    fmt::print("{}  {:<18} {}\n", summarize(found), "results", place.string());
  }
  return 0;
}

}  // namespace

void add_explain_verb(CLI::App& program, std::function<int()>& action) {
  CLI::App* verb = program.add_subcommand(
      "explain", "Find out what a model lacks: the effect, its size, the error before and after");
  const auto options = std::make_shared<Options>();
  verb->add_option("RECORD", options->explain.source.path,
                   "a truck's record: FILE.log (candump), FILE.csv, or a black box")
      ->required();
  verb->add_option("--validate", options->explain.validation,
                   "a record that is never fitted, only predicted (repeatable)")
      ->expected(1)
      ->take_all();
  verb->add_option("--config", options->config,
                   "configuration (TOML): [model] base and candidates, [car], [input]");
  verb->add_option("--out", options->out,
                   "run directory; default: a new one named after the record");
  verb->add_flag("--force", options->force, "replace an earlier run in --out");
  verb->add_flag("--json", options->json, "print explanation.json instead of a table");
  verb->add_flag("--quiet", options->quiet, "print nothing but errors and warnings");
  verb->add_flag("--skip-bad-lines", options->explain.source.skip_bad_lines,
                 "count malformed lines instead of stopping at the first");
  verb->callback([options, &action] { action = [options] { return explain(*options); }; });
}

}  // namespace dampline::app
