// SPDX-License-Identifier: MIT
#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <string_view>

#include "app/program.hpp"
#include "app/run/provenance.hpp"
#include "app/verbs/programs.hpp"
#include "app/verbs/verbs.hpp"

int main(int argc, char** argv) {
  if (argc > 1 && std::string_view{argv[1]} == "verify")
    return dampline::app::exit_code([&] { return dampline::app::run_verify(argv + 1); });
  if (argc > 1 && dampline::app::asks_for_method(argv + 1))
    return dampline::app::exit_code([&] { return dampline::app::run_method(argv + 1); });
  if (argc > 1 && dampline::app::is_rank(argv + 1))
    return dampline::app::exit_code([&] { return dampline::app::run_rank(argv + 1); });
  CLI::App program{
      "Identifies how a freight-car truck dissipates energy, from accelerometers in service"};
  program.name("dampline");
  const std::string commit = dampline::app::commit();
  program.set_version_flag("--version", "dampline " + dampline::app::version() +
                                            (commit.empty() ? "" : " (" + commit + ")"));
  program.require_subcommand(1);
  std::function<int()> action;
  dampline::app::add_identify_verb(program, action);
  dampline::app::add_explain_verb(program, action);
  dampline::app::add_simulate_verb(program, action);
  dampline::app::add_report_verb(program, action);
  dampline::app::add_compare_verb(program, action);
  dampline::app::add_merge_verb(program, action);
  dampline::app::add_archive_verb(program, action);
  dampline::app::add_collect_verb(program, action);
  dampline::app::add_fleet_verb(program, action);
  dampline::app::add_forward_verb(program, action);
  dampline::app::add_export_verb(program, action);
  dampline::app::list_verify_verb(program);
  dampline::app::add_inspect_verb(program, action);
  dampline::app::add_motion_verb(program, action);
  dampline::app::add_predict_verb(program, action);
  dampline::app::add_replay_verb(program, action);
  dampline::app::add_config_verb(program, action);
  dampline::app::add_completion_verb(program, action);
  return dampline::app::run(program, action, argc, argv);
}
