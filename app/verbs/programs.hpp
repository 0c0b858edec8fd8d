// SPDX-License-Identifier: MIT
#pragma once

namespace CLI {
class App;
}

// What is done by programs of their own, which lie beside this one or in ../libexec/dampline: they
// need the publications' methods, or MPI, which nothing else does. `arguments` are the verb and
// what follows it, as main() has them.
namespace dampline::app {

/// `dampline verify` in the program's help.
void list_verify_verb(CLI::App& program);

/// Becomes dampline-verify. Throws RunError where it lies in neither place.
int run_verify(char** arguments);

/// Whether the arguments are `archive ...` and mpirun, or another launcher, started this process.
[[nodiscard]] bool is_rank(char** arguments);
/// Becomes dampline-archive-mpi, a rank of it. Throws RunError where it lies in neither place.
int run_rank(char** arguments);

/// Whether the arguments are `identify ... --method NAME`.
[[nodiscard]] bool asks_for_method(char** arguments);
/// Becomes dampline-wavelet. Throws RunError where it lies in neither place.
int run_method(char** arguments);

}  // namespace dampline::app
