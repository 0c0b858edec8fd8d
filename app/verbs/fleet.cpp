// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <system_error>

#include "app/error.hpp"
#include "app/fleet/database.hpp"
#include "app/fleet/page/page.hpp"
#include "app/fleet/page/server.hpp"
#include "app/fleet/page/view.hpp"
#include "app/run/disk.hpp"
#include "app/verbs/verbs.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app {
namespace {

namespace fs = std::filesystem;
namespace pages = fleet::page;

struct FleetFlags {
  std::string database, vehicle, out, csv, serve, token_file;
  bool json{false}, force{false}, renew{false};
};

/// A page and tables, by the names that they have on a server.
void write_out(const FleetFlags& flags, fleet::store::Connection& connection) {
  const bool of_one = !flags.vehicle.empty();
  const fs::path folder{flags.out};
  const fs::path page = folder / (of_one ? "car.html" : "fleet.html");
  if (!flags.force && fs::exists(page))
    throw UsageError{fmt::format("{}: exists already; --force replaces it", page.string())};
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) fail_io(folder, "write into it", error.value());
  if (of_one) {
    const std::optional<pages::Car> car =
        pages::read_car(connection, flags.vehicle, pages::read_fleet(connection));
    if (!car)
      throw RunError{
          fmt::format("{}: has no car {}", connection.name(), drivers::quote(flags.vehicle))};
    for (const char* view : {"segment", "month"})
      write_file(folder / fmt::format("{}.csv", view),
                 pages::view_csv(connection, view, flags.vehicle));
    write_file(page, pages::car_page(*car, connection.name(), pages::Kind::kAlone));
    return;
  }
  const pages::Fleet all = pages::read_fleet(connection);
  for (const char* view : {"truck", "trend", "outlier", "norm"})
    write_file(folder / fmt::format("{}.csv", view),
               pages::view_csv(connection, view, std::nullopt));
  write_file(page, pages::fleet_page(all, connection.name(), pages::Kind::kAlone));
}

int show_fleet(const FleetFlags& flags) {
  if (!flags.serve.empty()) {
    pages::serve_fleet({flags.database, flags.serve, flags.token_file});
    return 0;
  }
  if (flags.renew) fleet::Database{flags.database, fleet::Database::Access::kWrite}.renew_trends();
  const fleet::Database database{flags.database, fleet::Database::Access::kRead};
  if (!flags.out.empty()) write_out(flags, database.connection());
  if (!flags.csv.empty()) {
    fmt::print(
        "{}", pages::view_csv(database.connection(), flags.csv,
                              flags.vehicle.empty() ? std::nullopt : std::optional{flags.vehicle}));
    return 0;
  }
  if (!flags.out.empty() && !flags.json) return 0;
  const pages::Fleet all = pages::read_fleet(database.connection());
  fmt::print(
      "{}", flags.json ? pages::fleet_json(all) : drivers::printable(pages::fleet_text(all), true));
  return 0;
}

}  // namespace

void add_fleet_verb(CLI::App& program, std::function<int()>& action) {
  CLI::App* verb = program.add_subcommand(
      "fleet", "A fleet by its database: levels, trends, outliers, contact; page, CSV, metrics");
  const auto flags = std::make_shared<FleetFlags>();
  verb->add_option("--db", flags->database,
                   "what `dampline collect` wrote: SQLite's file, or postgresql://...")
      ->required();
  CLI::Option* const serve = verb->add_option(
      "--serve", flags->serve, "HOST:PORT of pages, tables and /metrics, until a signal");
  verb->add_option("--serve-token-file", flags->token_file,
                   "file with the token of readers; an address beyond this machine needs it")
      ->needs(serve);
  verb->add_option("--out", flags->out, "folder for fleet.html and its tables as CSV")
      ->excludes(serve);
  verb->add_option("--vehicle", flags->vehicle,
                   "of this car alone: --out writes car.html, segment.csv and month.csv")
      ->excludes(serve);
  verb->add_option("--csv", flags->csv, "print a table: " + pages::view_names())->excludes(serve);
  verb->add_flag("--json", flags->json, "print totals, norms and outliers as JSON")
      ->excludes(serve);
  verb->add_flag("--force", flags->force, "replace files that exist in --out");
  verb->add_flag("--renew", flags->renew, "calculate all rows of table trend again first")
      ->excludes(serve);
  verb->callback([flags, &action] { action = [flags] { return show_fleet(*flags); }; });
}

}  // namespace dampline::app
