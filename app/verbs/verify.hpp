// SPDX-License-Identifier: MIT
#pragma once

namespace CLI {
class App;
}

namespace dampline::app {

/// `dampline verify` in the program's help. What it does is done by a program of its own.
void list_verify_verb(CLI::App& program);

/// Becomes dampline-verify, which lies beside this program or in ../libexec/dampline; `arguments`
/// are "verify" and what follows it, as main() has them. Throws RunError where it lies in neither.
int run_verify(char** arguments);

}  // namespace dampline::app
