// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "app/error.hpp"
#include "app/fleet/groups.hpp"
#include "app/fleet/leaves.hpp"
#include "app/fleet/merged.hpp"
#include "app/run/disk.hpp"
#include "app/verbs/run_flags.hpp"
#include "app/verbs/verbs.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app {
namespace {

struct MergeFlags : RunFlags {
  std::vector<std::string> sources;
  std::string by;
  std::string light;
  bool leave_out{false};
  int jobs{0};
};

/// The merge of one group, as a run directory at `place`.
fleet::GroupRow merge_group(const MergeFlags& options, const fleet::Group& group,
                            const std::filesystem::path& place,
                            std::vector<fleet::LeftOut>& left_out,
                            const std::vector<std::string>& notes) {
  RunDirectory directory{place, options.force};
  const std::vector<fleet::Leaf> leaves =
      fleet::check_alike(group.leaves, options.leave_out ? &left_out : nullptr);
  const fleet::Merged merged = fleet::merge_alike(
      leaves, fleet::chunks_by_threads(leaves, fleet::jobs_or_all(options.jobs)));
  RunFiles files = fleet::files_of(merged, leaves, options.sources, notes);
  if (!options.light.empty())
    write_file(options.light, encode_state(*merged.sums, merged.about, StateKind::kLight));
  options.write(files, directory);
  return {group.labels, leaves.size(), std::move(files.result), place.string()};
}

void check_usage(const MergeFlags& options) {
  if (!options.light.empty() && !options.by.empty())
    throw UsageError{"--light: is of one merge, and --by makes several"};
  std::error_code error;
  if (!options.light.empty() && !options.force && std::filesystem::exists(options.light, error))
    throw UsageError{fmt::format("{}: exists already; --force replaces it", options.light)};
  const std::filesystem::path table = std::filesystem::path{options.out} / "groups.csv";
  if (!options.by.empty() && !options.force && std::filesystem::exists(table, error))
    throw UsageError{fmt::format("{}: exists already; --force replaces it", table.string())};
}

void print_merge(const MergeFlags& options, const std::vector<fleet::By>& by,
                 const std::vector<fleet::GroupRow>& rows,
                 const std::vector<fleet::LeftOut>& left_out) {
  if (options.json) fmt::print("{}", fleet::to_json(by, rows, left_out));
  if (options.json || options.quiet) return;
  fmt::print("{}", drivers::printable(fleet::to_text(by, rows), true));
  for (const fleet::LeftOut& state : left_out)
    fmt::print("left out: {}\n",
               drivers::printable(fmt::format("{}: {}", state.file.string(), state.reason)));
}

int merge_states(const MergeFlags& options) {
  const std::vector<fleet::By> by = fleet::parse_by(options.by);
  check_usage(options);
  fleet::Leaves found = fleet::find_leaves(options.sources);
  std::vector<fleet::GroupRow> rows;
  for (const fleet::Group& group : fleet::group(std::move(found.list), by)) {
    const std::filesystem::path place = std::filesystem::path{options.out} / group.name();
    rows.push_back(merge_group(options, group,
                               by.empty() ? std::filesystem::path{options.out} : place,
                               found.left_out, found.notes));
  }
  if (!by.empty())
    write_file(std::filesystem::path{options.out} / "groups.csv", fleet::to_csv(by, rows));
  print_merge(options, by, rows, found.left_out);
  for (const fleet::GroupRow& row : rows)
    for (const std::string& warning : row.result.warnings)
      if (!options.quiet) warn(warning);
  int code = 0;
  for (const fleet::GroupRow& row : rows) code = std::max(code, options.verdict(row.result));
  return code;
}

}  // namespace

void add_merge_verb(CLI::App& program, std::function<int()>& action) {
  CLI::App* verb = program.add_subcommand(
      "merge",
      "Many runs' states as one run: the same bytes in any order, split or number of jobs");
  const auto options = std::make_shared<MergeFlags>();
  verb->add_option("STATE", options->sources,
                   "states (FILE.dls), run directories of trucks, or directories of these; each "
                   "segment of a truck counts once, by its latest state")
      ->required();
  verb->add_option("--out", options->out, "run directory; with --by a directory of them")
      ->required();
  verb->add_option("--by", options->by,
                   "a run for each group: some of vehicle,truck,load,month; groups.csv lists them");
  verb->add_option("--light", options->light,
                   "write the merge as a light state as well: some 5 KB, for telemetry");
  verb->add_flag("--leave-out", options->leave_out,
                 "leave out, and list, states that cannot be added instead of ending");
  verb->add_option("--jobs", options->jobs, "threads; default: as the machine has processors")
      ->check(CLI::Range(1, 1024));
  verb->add_flag("--json", options->json, "print groups and what was left out as JSON");
  verb->add_flag("--quiet", options->quiet, "print nothing but errors");
  verb->add_flag("--force", options->force, "replace earlier runs in --out");
  verb->add_flag("--no-report", options->no_report, "do not draw report.html");
  options->add_strict(*verb);
  verb->callback([options, &action] { action = [options] { return merge_states(*options); }; });
}

}  // namespace dampline::app
