// SPDX-License-Identifier: MIT
#pragma once
#include <functional>

namespace CLI {
class App;
}

namespace dampline::app {

/// Adds `dampline verify` to the program. When it is chosen, `action` becomes what to do; it
/// returns the exit code and throws RunError or UsageError.
void add_verify_verb(CLI::App& program, std::function<int()>& action);

}  // namespace dampline::app
