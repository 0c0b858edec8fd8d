// SPDX-License-Identifier: MIT
// Feeds the motion of a recorded ride to a FokkerPlanck; run under valgrind by
// density_cost_test.cpp, which counts the instructions of each call of density_measured().
// Usage: density_probe MOTIONS MEMORY_S FIRST
// MOTIONS is a file of Motion structs; those from FIRST on go through density_measured().
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "dampline/density/fokker_planck.hpp"

namespace {

dampline::FokkerPlanck* density = nullptr;

}  // namespace

/// A plain name, so that valgrind can be told it.
extern "C" [[gnu::noinline]] void density_measured(const dampline::Motion& motion) {
  density->update(motion);
}

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  std::FILE* file = std::fopen(argv[1], "rb");
  if (file == nullptr) return 1;
  const auto owner = std::make_unique<dampline::FokkerPlanck>(
      dampline::FokkerPlanckConfig{.memory_s = std::atof(argv[2])});
  density = owner.get();
  const long first = std::atol(argv[3]);
  dampline::Motion motion;
  for (long i = 0; std::fread(&motion, sizeof motion, 1, file) == 1; ++i) {
    if (i >= first) {
      density_measured(motion);
    } else {
      density->update(motion);
    }
  }
  std::fclose(file);
  return 0;
}
