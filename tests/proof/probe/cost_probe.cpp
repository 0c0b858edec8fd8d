// SPDX-License-Identifier: MIT
// Feeds recorded samples to an Estimator; run under valgrind by update_cost_test.cpp, which
// counts the instructions of each call of update_measured().
// Usage: cost_probe SAMPLES MEMORY FIRST LAST
// SAMPLES is a file of Sample structs; FIRST <= i < LAST go through update_measured().
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "dampline/damping/estimator.hpp"

namespace {

dampline::Estimator* identifier = nullptr;

}  // namespace

/// A plain name, so that valgrind can be told it.
extern "C" [[gnu::noinline]] void update_measured(const dampline::Sample& sample) {
  static_cast<void>(identifier->update(sample));
}

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  std::FILE* file = std::fopen(argv[1], "rb");
  if (file == nullptr) return 1;
  const long first = std::atol(argv[3]);
  const long last = std::atol(argv[4]);
  const dampline::EstimatorConfig config{
      .memory = static_cast<dampline::Memory>(std::atoi(argv[2])), .memory_s = 30.0};
  const auto owner = std::make_unique<dampline::Estimator>(config);
  identifier = owner.get();
  dampline::Sample sample;
  for (long i = 0; i < last && std::fread(&sample, sizeof sample, 1, file) == 1; ++i) {
    if (i >= first) {
      update_measured(sample);
    } else {
      static_cast<void>(identifier->update(sample));
    }
  }
  std::fclose(file);
  return 0;
}
