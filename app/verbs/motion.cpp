// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "app/error.hpp"
#include "app/motion/series.hpp"
#include "app/motion/writers.hpp"
#include "app/record/columns.hpp"
#include "app/record/rate.hpp"
#include "app/record/source_kind.hpp"
#include "app/verbs/verbs.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app {
namespace {

struct MotionFlags {
  SourceOptions source;
  std::string config;
  std::string out;
  bool force{false};
  bool json{false};
  bool quiet{false};
};

int write_series(const MotionFlags& flags) {
  const MotionFormat format = motion_format(flags.out);
  if (flags.json && flags.out == "-")
    throw UsageError{"--json: prints on the standard output, expected a file in --out"};
  const Config given = flags.config.empty() ? Config{} : load_config(flags.config);
  const RecognisedColumns seen = recognise_columns(given, flags.source);
  const SourceKind kind = detect_source(seen.config, flags.source);
  if (kind == SourceKind::kInterface)
    throw UsageError{fmt::format("{}: is an interface, expected a record", flags.source.path)};
  if (kind == SourceKind::kRigRows)
    throw UsageError{fmt::format(
        "{}: is a rig's record, which holds its deflection; expected a truck's accelerations",
        flags.source.path)};
  const bool progress = !flags.quiet && ::isatty(STDERR_FILENO) == 1;
  MotionSeries series{with_record_rate(seen.config, flags.source, kind), flags.source, kind,
                      progress};
  write_motion(series, flags.out, format, flags.force);
  if (flags.json) fmt::print("{}", motion_json(series.summary()));
  if (!flags.json && !flags.quiet)
    fmt::print(flags.out == "-" ? stderr : stdout, "{}-> {}\n", motion_text(series.summary()),
               flags.out == "-" ? "standard output" : drivers::printable(flags.out));
  return 0;
}

}  // namespace

void add_motion_verb(CLI::App& program, std::function<int()>& action) {
  CLI::App* verb = program.add_subcommand(
      "motion", "Write deflection and velocity of a truck's whole record as a table");
  const auto flags = std::make_shared<MotionFlags>();
  verb->add_option("SOURCE", flags->source.path,
                   "a truck's record of any format, a black box, or - for standard input")
      ->required();
  verb->add_option("--out", flags->out,
                   "FILE.csv, FILE.npy, FILE.mat or FILE.h5; - is CSV on the standard output")
      ->required();
  verb->add_option("--config", flags->config, "configuration (TOML), as for identify");
  verb->add_flag("--force", flags->force, "replace a file that exists");
  verb->add_flag("--json", flags->json, "print latency, noise and band as JSON");
  verb->add_flag("--quiet", flags->quiet, "print nothing but errors and warnings");
  verb->add_flag("--skip-bad-lines", flags->source.skip_bad_lines,
                 "count malformed lines instead of stopping at the first");
  verb->callback([flags, &action] { action = [flags] { return write_series(*flags); }; });
}

}  // namespace dampline::app
