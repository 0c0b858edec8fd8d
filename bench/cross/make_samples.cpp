// SPDX-License-Identifier: MIT
// Writes a simulated ride as counts, for programs without files, or as a log of candump for the
// examples: `make_samples SECONDS [candump]`.
#include <cstdio>
#include <cstdlib>

#include "sim_hw/simulation.hpp"

namespace {

/// The three channels' frames: count in 12 bits, then a counter in 12 bits.
void print_frames(long tick, const dampline::sim::SimulatedSample& sample) {
  const long long us = tick * 10'000 / 3;
  for (unsigned c = 0; c < dampline::kChannels; ++c) {
    const unsigned count = static_cast<unsigned>(sample.counts[c]) & 0xFFFU;
    const unsigned counter = static_cast<unsigned>(tick) & 0xFFFU;
    std::printf("(%lld.%06lld) can0 %03X#%02X%02X%02X00\n", us / 1'000'000, us % 1'000'000,
                0x310U + c, count & 0xFFU, (counter & 0xFU) << 4U | count >> 8U, counter >> 4U);
  }
}

}  // namespace

int main(int argc, char** argv) {
  using namespace dampline;
  const long samples = (argc > 1 ? std::atol(argv[1]) : 60) * sim::kSampleRateHz;
  sim::Simulation simulation{sim::reference_run(sim::Load::kLaden, 80.0, 1)};
  for (long i = 0; i < samples; ++i) {
    const sim::SimulatedSample sample = simulation.next();
    if (argc > 2)
      print_frames(i, sample);
    else
      std::printf("{%d,%d,%d},\n", sample.counts[0], sample.counts[1], sample.counts[2]);
  }
  return 0;
}
