// SPDX-License-Identifier: MIT
#include "app/compare/compare.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "app/error.hpp"
#include "app/run/disk.hpp"
#include "app/verbs/verbs.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app {
namespace {

struct CompareOptions {
  std::vector<std::string> runs;
  std::string out;
  bool json{false};
  bool force{false};
};

constexpr const char* kPageName = "compare.html";
constexpr const char* kJsonName = "comparison.json";

void check_place(const CompareOptions& options) {
  for (const char* name : {kPageName, kJsonName})
    if (const auto file = std::filesystem::path{options.out} / name;
        !options.force && std::filesystem::exists(file))
      throw UsageError{fmt::format("{}: exists already; --force replaces it", file.string())};
}

int compare_runs(const CompareOptions& options) {
  if (options.runs.size() < 2)
    throw UsageError{
        fmt::format("RUN: found {}, expected two run directories or more", options.runs.size())};
  if (!options.out.empty()) check_place(options);
  const std::vector<compare::Run> runs = compare::read_runs(options.runs);
  const std::string json = compare::to_json(runs);
  if (!options.out.empty()) {
    std::error_code error;
    std::filesystem::create_directories(options.out, error);
    if (error) fail_io(options.out, "write into it", error.value());
    write_file(std::filesystem::path{options.out} / kJsonName, json);
    write_file(std::filesystem::path{options.out} / kPageName, compare::make_page(runs));
  }
  fmt::print("{}", options.json ? json : drivers::printable(compare::to_text(runs), true));
  return 0;
}

}  // namespace

void add_compare_verb(CLI::App& program, std::function<int()>& action) {
  CLI::App* verb = program.add_subcommand(
      "compare", "Runs side by side, and how far each is from the first, in standard deviations");
  const auto options = std::make_shared<CompareOptions>();
  verb->add_option("RUN", options->runs,
                   "run directories, all of trucks with one basis and mass or all of rigs; the "
                   "others are compared with the first")
      ->required();
  verb->add_option("--out", options->out,
                   "folder for compare.html, which has level and stiffness over the date, and "
                   "comparison.json");
  verb->add_flag("--json", options->json, "print comparison.json instead of the tables");
  verb->add_flag("--force", options->force, "replace files that exist in --out");
  verb->callback([options, &action] { action = [options] { return compare_runs(*options); }; });
}

}  // namespace dampline::app
