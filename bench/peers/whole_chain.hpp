// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>

#include "bench/peers/outcome.hpp"
#include "dampline/damping/estimator.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::bench {

/// A simulated laden car through Identifiers of every kind of memory: the larger of the relative
/// errors of friction and stiffness.
class WholeChain {
 public:
  static constexpr std::size_t kMemories = 3;
  static constexpr std::array<const char*, kMemories> kNames{
      "dampline, Estimator, all of the record", "dampline, Estimator, window of 300 s",
      "dampline, Estimator, forgetting, 300 s"};
  using Outcomes = std::array<Outcome, kMemories>;

  /// Good excitation, with a look after `first_s`.
  static Outcomes day(double first_s, double seconds) {
    WholeChain chain{sim::reference_run(sim::Load::kLaden, 80.0, 1)};
    Outcomes out;
    chain.run(first_s);
    chain.look([&](std::size_t m, double error) { out[m].error_before = error; });
    chain.run(seconds - first_s);
    chain.conclude(out);
    return out;
  }

  /// `drive_s` of motion, the standstill, and as much motion again.
  static Outcomes standstill(double drive_s, double seconds) {
    sim::SimulationConfig config = sim::reference_run(sim::Load::kLaden, 80.0, 1);
    const double braking_s = config.speed.speed_mps / config.speed.ramp_mps2;
    const double stop_s = drive_s + braking_s;
    config.speed.standstills[0] = {stop_s, stop_s + seconds};
    WholeChain chain{config};
    Outcomes out;
    chain.run(drive_s);
    chain.look([&](std::size_t m, double error) { out[m].error_before = error; });
    chain.run(2.0 * braking_s + seconds + drive_s);
    chain.conclude(out);
    return out;
  }

 private:
  static constexpr double kLookEveryS = 60.0;

  explicit WholeChain(const sim::SimulationConfig& config) : truck_{config.truck}, sim_{config} {
    for (std::size_t m = 0; m < kMemories; ++m) {
      EstimatorConfig identifier;
      identifier.moving_mass_kg = truck_.moving_mass_kg;
      identifier.memory = static_cast<Memory>(m);
      identifier.memory_s = identifier.memory == Memory::kInfinite ? 0.0 : 300.0;
      identifiers_[m] = std::make_unique<Estimator>(identifier);
    }
  }

  void run(double seconds) {
    const auto samples = std::llround(seconds * sim::kSampleRateHz);
    for (std::int64_t i = 0; i < samples; ++i) {
      const Sample sample = sim::to_sample(sim_.next());
      for (const auto& identifier : identifiers_) static_cast<void>(identifier->update(sample));
      if (++taken_ % std::llround(kLookEveryS * sim::kSampleRateHz) != 0) continue;
      look([&](std::size_t m, double error) {
        known_[m] = known_[m] || std::isfinite(error);
        if (nan_after_s_[m] < 0.0 && known_[m] && !std::isfinite(error))
          nan_after_s_[m] = static_cast<double>(taken_) / sim::kSampleRateHz;
      });
    }
  }

  template <class Take>
  void look(Take take) {
    for (std::size_t m = 0; m < kMemories; ++m) take(m, error_of(identifiers_[m]->snapshot()));
  }

  void conclude(Outcomes& out) {
    look([&](std::size_t m, double error) {
      out[m].error_after = error;
      out[m].nan_after_s = nan_after_s_[m];
    });
  }

  [[nodiscard]] double error_of(const Snapshot& s) const {
    if (!s.valid) return std::nan("");
    const double coulomb_n =
        0.5 * truck_.friction_scale * (truck_.friction_positive_n + truck_.friction_negative_n);
    return std::fmax(std::abs(s.coulomb_n.value / coulomb_n - 1.0),
                     std::abs(s.stiffness_npm.value / truck_.stiffness_npm - 1.0));
  }

  sim::TruckConfig truck_;
  sim::Simulation sim_;
  std::array<std::unique_ptr<Estimator>, kMemories> identifiers_;
  std::array<bool, kMemories> known_{};  // there was an estimate before
  std::array<double, kMemories> nan_after_s_{-1.0, -1.0, -1.0};
  std::int64_t taken_{0};
};

}  // namespace dampline::bench
