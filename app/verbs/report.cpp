// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "app/report/page.hpp"
#include "app/run/directory.hpp"
#include "app/run/disk.hpp"
#include "app/verbs/verbs.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app {
namespace {

int rebuild_report(const std::filesystem::path& run) {
  const RunFiles files = read_files(run);
  const Provenance provenance = read_provenance(files.run_toml, (run / "run.toml").string());
  write_file(run / "report.html", make_page(files.result, provenance, files.run_toml));
  fmt::print("{}\n", drivers::printable((run / "report.html").string()));
  return 0;
}

}  // namespace

void add_report_verb(CLI::App& program, std::function<int()>& action) {
  CLI::App* verb =
      program.add_subcommand("report", "Rebuild a run's report.html from its other files");
  const auto run = std::make_shared<std::string>();
  verb->add_option("RUN", *run, "run directory")->required();
  verb->callback([run, &action] { action = [run] { return rebuild_report(*run); }; });
}

}  // namespace dampline::app
