// SPDX-License-Identifier: MIT
#include "app/inspect/inspect.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "app/verbs/verbs.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app {

void add_inspect_verb(CLI::App& program, std::function<int()>& action) {
  CLI::App* verb = program.add_subcommand(
      "inspect", "Say what a record or a bus holds, and the configuration to paste");
  const auto options = std::make_shared<InspectOptions>();
  const auto json = std::make_shared<bool>(false);
  verb->add_option("SOURCE", options->source,
                   "a record of any format, a black box, an interface, or - for standard input")
      ->required();
  verb->add_option("--dbc", options->dbc,
                   "DBC file of the frames; default: the project's own sensors");
  constexpr double kHourS = 3600.0;
  verb->add_option("--duration", options->duration_s, "s for which an interface is listened to")
      ->check(CLI::Range(0.1, kHourS))
      ->capture_default_str();
  verb->add_flag("--json", *json, "print it as JSON");
  verb->callback([options, json, &action] {
    action = [options, json] {
      const Inspection found = inspect(*options);
      fmt::print("{}",
                 *json ? inspection_json(found) : drivers::printable(inspection_text(found), true));
      return 0;
    };
  });
}

}  // namespace dampline::app
