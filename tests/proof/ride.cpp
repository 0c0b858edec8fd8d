// SPDX-License-Identifier: MIT
#include "tests/proof/ride.hpp"

#include <limits>

#include "sim_hw/simulation.hpp"

namespace dampline::proof {

std::vector<Sample> laden_ride(double duration_s) {
  sim::Simulation simulation{sim::SimulationConfig{}};
  std::vector<Sample> ride;
  const auto samples = static_cast<std::size_t>(duration_s * sim::kSampleRateHz);
  ride.reserve(samples);
  while (ride.size() < samples) ride.push_back(sim::to_sample(simulation.next()));
  return ride;
}

void Trouble::apply(Sample& sample) noexcept {
  ++made_;
  const auto due = [this](std::int64_t samples) { return made_ % (samples * rarity_) == 0; };
  if (due(4'009)) tick_ += 7;
  if (due(18'013)) tick_ += 1'000'000;
  if (due(5'021)) sample.saturated = 1;
  if (due(6'011)) sample.accel_mps2[1] = std::numeric_limits<double>::quiet_NaN();
  if (!due(7'001)) ++tick_;
  sample.tick = tick_;
}

}  // namespace dampline::proof
