// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/error.hpp"
#include "app/fleet/database.hpp"
#include "app/fleet/leaves.hpp"
#include "app/run/json.hpp"
#include "app/text/format.hpp"
#include "app/verbs/verbs.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app {
namespace {

struct CollectFlags {
  std::vector<std::string> sources;
  std::string database;
  bool json{false};
  bool quiet{false};
};

struct Collected {
  std::uint64_t fresh{0};
  std::uint64_t later{0};
  std::uint64_t known{0};
  std::uint64_t merges{0};  ///< passed over
  std::vector<fleet::LeftOut> refused;
};

void collect_file(fleet::Database& database, const std::filesystem::path& file, Statistics& scratch,
                  Collected& out) {
  try {
    std::string bytes = fleet::file_reader(file)();
    const fleet::Leaf leaf = fleet::leaf_of(
        file, [&bytes] { return bytes; }, scratch);
    if (leaf.about.segments > 1) {
      ++out.merges;
      return;
    }
    switch (database.put(leaf, bytes)) {
      case fleet::Stored::kNew:
        ++out.fresh;
        break;
      case fleet::Stored::kLater:
        ++out.later;
        break;
      case fleet::Stored::kKnown:
        ++out.known;
        break;
    }
  } catch (const RunError& error) {
    database.refuse(file.string(), error.what());
    out.refused.push_back({file, error.what()});
  }
}

void print_collected(const CollectFlags& flags, const fleet::Database& database,
                     const Collected& c) {
  if (flags.json) {
    fmt::print("{}", json_text({{"schema", "dampline.collect/1"},
                                {"states_new", c.fresh},
                                {"states_later", c.later},
                                {"states_known", c.known},
                                {"merges_passed_over", c.merges},
                                {"refused", fleet::to_json(c.refused)},
                                {"segments", database.states()}}));
    return;
  }
  if (flags.quiet) return;
  fmt::print("{} new, {} later, {} known; {} segments in {}\n", c.fresh, c.later, c.known,
             database.states(), drivers::printable(database.connection().name()));
}

int collect(const CollectFlags& flags) {
  constexpr std::size_t kTogether = 200;  // states in one transaction
  fleet::Database database{flags.database, fleet::Database::Access::kWrite};
  const auto scratch = std::make_unique<Statistics>();
  Collected out;
  const std::vector<std::filesystem::path> files = fleet::state_files(flags.sources);
  for (std::size_t begin = 0; begin < files.size(); begin += kTogether) {
    database.begin();
    for (std::size_t i = begin; i < std::min(begin + kTogether, files.size()); ++i)
      collect_file(database, files[i], *scratch, out);
    database.commit();
  }
  print_collected(flags, database, out);
  for (const fleet::LeftOut& state : out.refused) warn("refused: " + state.reason);
  return 0;
}

}  // namespace

void add_collect_verb(CLI::App& program, std::function<int()>& action) {
  CLI::App* verb = program.add_subcommand(
      "collect", "States that cars have sent or left on a disk, into one database of the fleet");
  const auto flags = std::make_shared<CollectFlags>();
  verb->add_option("STATE", flags->sources,
                   "states, run directories of trucks, or directories of these: a spool, a stick")
      ->required();
  verb->add_option(
          "--db", flags->database,
          "SQLite's file, made where it is missing, or postgresql://...; `dampline merge` of "
          "either merges it")
      ->required();
  verb->add_flag("--json", flags->json, "print what was done as JSON");
  verb->add_flag("--quiet", flags->quiet, "print nothing but errors and warnings");
  verb->callback([flags, &action] { action = [flags] { return collect(*flags); }; });
}

}  // namespace dampline::app
