// SPDX-License-Identifier: MIT
#include "app/config/config.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "app/error.hpp"
#include "app/inspect/check.hpp"
#include "app/verbs/verbs.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app {
namespace {

/// `record` empty: without one.
int check(const std::string& file, const std::string& record) {
  const Config config = load_config(file);
  std::string found;
  try {
    check_configuration(config);
    if (!record.empty()) found = check_against_record(config, {record, false});
  } catch (const UsageError& error) {
    throw UsageError{fmt::format("{}: {}", file, error.what())};
  }
  fmt::print("{}: right\n{}", drivers::printable(file), drivers::printable(found, true));
  return 0;
}

}  // namespace

void add_config_verb(CLI::App& program, std::function<int()>& action) {
  CLI::App* config = program.add_subcommand("config", "Check a configuration, or complete it");
  config->require_subcommand(1);
  const auto file = std::make_shared<std::string>();

  CLI::App* checks = config->add_subcommand("check", "Say whether a configuration file is right");
  const auto record = std::make_shared<std::string>();
  checks->add_option("FILE", *file, "configuration (TOML)")->required();
  checks->add_option("--record", *record,
                     "a record that it is for: its first minute is read with it");
  checks->callback(
      [file, record, &action] { action = [file, record] { return check(*file, *record); }; });

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
