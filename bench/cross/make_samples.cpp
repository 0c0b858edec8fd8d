// SPDX-License-Identifier: MIT
// Writes a simulated ride as counts, for programs without files: `make_samples SECONDS`.
#include <cstdio>
#include <cstdlib>

#include "sim_hw/simulation.hpp"

int main(int argc, char** argv) {
  using namespace dampline;
  const long samples = (argc > 1 ? std::atol(argv[1]) : 60) * sim::kSampleRateHz;
  sim::Simulation simulation{sim::reference_run(sim::Load::kLaden, 80.0, 1)};
  for (long i = 0; i < samples; ++i) {
    const sim::SimulatedSample sample = simulation.next();
    std::printf("{%d,%d,%d},\n", sample.counts[0], sample.counts[1], sample.counts[2]);
  }
  return 0;
}
