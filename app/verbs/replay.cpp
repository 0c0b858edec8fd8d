// SPDX-License-Identifier: MIT
#include "app/live/replay.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>

#include "app/error.hpp"
#include "app/record/columns.hpp"
#include "app/record/rate.hpp"
#include "app/run/provenance.hpp"
#include "app/text/summary.hpp"
#include "app/verbs/verbs.hpp"
#include "drivers/text/quote.hpp"
#include "drivers/text/whole_file.hpp"

namespace dampline::app {
namespace {

struct ReplayFlags {
  SourceOptions source;
  std::string config;
  std::string serve;
  std::string token_file;
  ReplayOptions replay;
  bool quiet{false};
};

/// What a run directory was made of: its black box, else the record that it names.
std::string source_of_run(const std::filesystem::path& run) {
  if (std::filesystem::is_directory(run / "blackbox")) return (run / "blackbox").string();
  constexpr std::size_t kMostBytes = std::size_t{1} << 20U;
  const std::string file = (run / "run.toml").string();
  const auto text = drivers::read_whole(file, kMostBytes);
  if (!text.ok()) throw RunError{text.error_text()};
  const Provenance made = read_provenance(text.value(), file);
  if (made.inputs.empty()) throw RunError{fmt::format("{}: names no record", file)};
  return made.inputs.front().name;
}

int replay_record(ReplayFlags flags) {
  const std::filesystem::path given{flags.source.path};
  const bool is_run = std::filesystem::exists(given / "run.toml");
  if (is_run) {
    flags.source.path = source_of_run(given);
    if (flags.config.empty()) flags.config = (given / "run.toml").string();
  }
  Config config = flags.config.empty() ? Config{} : load_config(flags.config);
  if (!flags.serve.empty()) config.serve.address = flags.serve;
  if (!flags.token_file.empty()) config.serve.token_file = flags.token_file;
  const RecognisedColumns seen = recognise_columns(config, flags.source);
  const SourceKind kind = detect_source(seen.config, flags.source);
  flags.replay.show_progress = !flags.quiet && ::isatty(STDERR_FILENO) == 1;
  const RunResult result =
      replay(with_record_rate(seen.config, flags.source, kind), flags.source, kind, flags.replay);
  if (!flags.quiet) fmt::print("{}", drivers::printable(summarize(result), true));
  return 0;
}

}  // namespace

void add_replay_verb(CLI::App& program, std::function<int()>& action) {
  constexpr double kMostSpeed = 1000.0;
  CLI::App* verb = program.add_subcommand(
      "replay", "Show a recorded run as a live one is shown: page, metrics, events");
  const auto flags = std::make_shared<ReplayFlags>();
  verb->add_option("RECORD", flags->source.path,
                   "a truck's record of any format, a black box, or a run directory")
      ->required();
  verb->add_option("--serve", flags->serve,
                   "HOST:PORT of page, metrics and events; default: as configured");
  verb->add_option("--serve-token-file", flags->token_file,
                   "file with the token of readers; an address beyond this machine needs it");
  verb->add_option("--speed", flags->replay.speed, "times real time; 0: as fast as it goes")
      ->check(CLI::Range(0.0, kMostSpeed))
      ->capture_default_str();
  verb->add_option("--publish-every", flags->replay.publish_every_s,
                   "s between two results; default: 10 s of the record, but 0.5 to 10 s")
      ->check(CLI::Range(0.1, 1e6));
  verb->add_flag("--end", flags->replay.end, "end with the record, not on a signal");
  verb->add_option("--config", flags->config,
                   "configuration (TOML); default: that of the run, else none");
  verb->add_flag("--quiet", flags->quiet, "print nothing but errors and warnings");
  verb->add_flag("--skip-bad-lines", flags->source.skip_bad_lines,
                 "count malformed lines instead of stopping at the first");
  verb->callback([flags, &action] { action = [flags] { return replay_record(*flags); }; });
}

}  // namespace dampline::app
