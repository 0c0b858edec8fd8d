// SPDX-License-Identifier: MIT
#pragma once
#include <functional>

namespace CLI {
class App;
}

namespace dampline::app {

// Each adds its verb to the program. When it is chosen, `action` becomes what to do; that returns
// the exit code and throws RunError or UsageError.

void add_identify_verb(CLI::App& program, std::function<int()>& action);
void add_explain_verb(CLI::App& program, std::function<int()>& action);
void add_simulate_verb(CLI::App& program, std::function<int()>& action);
void add_report_verb(CLI::App& program, std::function<int()>& action);
void add_compare_verb(CLI::App& program, std::function<int()>& action);
void add_merge_verb(CLI::App& program, std::function<int()>& action);
void add_archive_verb(CLI::App& program, std::function<int()>& action);
void add_collect_verb(CLI::App& program, std::function<int()>& action);
void add_fleet_verb(CLI::App& program, std::function<int()>& action);
void add_forward_verb(CLI::App& program, std::function<int()>& action);
void add_export_verb(CLI::App& program, std::function<int()>& action);
void add_inspect_verb(CLI::App& program, std::function<int()>& action);
void add_motion_verb(CLI::App& program, std::function<int()>& action);
void add_predict_verb(CLI::App& program, std::function<int()>& action);
void add_replay_verb(CLI::App& program, std::function<int()>& action);
void add_config_verb(CLI::App& program, std::function<int()>& action);
void add_completion_verb(CLI::App& program, std::function<int()>& action);

}  // namespace dampline::app
