// SPDX-License-Identifier: MIT
#pragma once
#include <functional>

namespace CLI {
class App;
}

namespace dampline::app {

/// `dampline explain RECORD`: names the effect that a model lacks, with the error before and after.
void add_explain_verb(CLI::App& program, std::function<int()>& action);

}  // namespace dampline::app
