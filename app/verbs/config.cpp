// SPDX-License-Identifier: MIT
#include "app/config/config.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "app/verbs/verbs.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app {

void add_config_verb(CLI::App& program, std::function<int()>& action) {
  CLI::App* config = program.add_subcommand("config", "Check a configuration, or complete it");
  config->require_subcommand(1);
  const auto file = std::make_shared<std::string>();

  CLI::App* check = config->add_subcommand("check", "Say whether a configuration file is right");
  check->add_option("FILE", *file, "configuration (TOML)")->required();
  check->callback([file, &action] {
    action = [file] {
      static_cast<void>(load_config(*file));
      fmt::print("{}: right\n", drivers::printable(*file));
      return 0;
    };
  });

  CLI::App* show =
      config->add_subcommand("show", "Print the complete configuration, defaults included");
  show->add_option("FILE", *file, "configuration (TOML); none: all defaults");
  show->callback([file, &action] {
    action = [file] {
      fmt::print("{}", show_config(file->empty() ? Config{} : load_config(*file)));
      return 0;
    };
  });
}

}  // namespace dampline::app
