// SPDX-License-Identifier: MIT
// The floor that a surrogate gives against clean records, whose error is the floor.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "dampline/effect/explainer.hpp"
#include "dampline/effect/surrogate.hpp"
#include "dampline/motion/frame_noise.hpp"
#include "sim_hw/effects/registry.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::app {
namespace {

constexpr double kRateHz = 300.0;

TEST(FrameNoise, IsKnownToAFewPercentUnderFrictionsLeaps) {
  for (const double scale : {1.0, 2.5}) {
    for (const sim::Load load : {sim::Load::kLaden, sim::Load::kEmpty}) {
      sim::SimulationConfig config = sim::reference_run(load, 80.0, 17);
      config.sensors.noise_mps2 *= scale;
      sim::Simulation simulation{config};
      FrameNoise noise{kRateHz, {}};
      for (int n = 0; n < 300 * 300; ++n) noise.take(sim::to_sample(simulation.next()));
      const double step = sim::count_scale_mps2(config.sensors.range_mps2[0]);
      const double truth =
          std::sqrt(config.sensors.noise_mps2 * config.sensors.noise_mps2 + step * step / 12.0);
      EXPECT_NEAR(noise.noise_mps2(), truth, 0.06 * truth);
    }
  }
}

TEST(FrameNoise, IsUnknownOfAShortRecord) {
  FrameNoise noise{kRateHz, {}};
  for (int n = 0; n < 3000; ++n) noise.take({.tick = n});
  EXPECT_EQ(noise.noise_mps2(), 0.0);
}

struct Floor {
  effect::Explanation explanation;
  double truth{0.0};  // held-out nmse of the base on the record
};

/// A record of a condition, explained, with its floor; `effect` empty: clean.
Floor floor_of(sim::Load load, double speed_kmh, const char* effect, double noise_scale) {
  sim::SimulationConfig config = sim::reference_run(load, speed_kmh, 91);
  if (*effect != '\0') {
    EXPECT_FALSE(sim::add_effect_text(config, effect));
  }
  config.sensors.noise_mps2 *= noise_scale;
  sim::Simulation simulation{config};
  EstimatorConfig core;
  core.moving_mass_kg = config.truck.moving_mass_kg;
  const auto identifier = std::make_unique<Estimator>(core);
  const auto diagnosis = std::make_unique<effect::Diagnosis>(core);
  FrameNoise noise{kRateHz, core.anti_alias};
  std::vector<Sample> samples;
  for (int n = 0; n < 200 * 300; ++n) {
    samples.push_back(sim::to_sample(simulation.next()));
    noise.take(samples.back());
    diagnosis->update(samples.back(), identifier->update(samples.back()));
  }
  diagnosis->finish();
  const auto explainer = std::make_unique<effect::Explainer>();
  Floor out;
  out.explanation = explainer->explain(*diagnosis, {.moving_mass_kg = core.moving_mass_kg});
  effect::Explanation& e = out.explanation;
  effect::SurrogateConfig settings;
  settings.stiffness_per_s2 = e.final_stiffness_npm.value / core.moving_mass_kg;
  settings.coulomb_mps2 = e.final_coulomb_n.value / core.moving_mass_kg;
  settings.input_low_pass_hz = settings.low_pass_hz = core.anti_alias.corner_hz;
  for (std::size_t c = 0; c < kChannels; ++c) {
    settings.step_mps2[c] = sim::count_scale_mps2(config.sensors.range_mps2[c]);
    const auto rounding = [&](std::size_t i) { return settings.step_mps2[i] / std::sqrt(12.0); };
    // The frame's, with the channel's own resolution.
    settings.noise_mps2[c] = std::sqrt(std::pow(noise.noise_mps2(), 2) - std::pow(rounding(0), 2) +
                                       std::pow(rounding(c), 2));
  }
  std::array<std::unique_ptr<effect::Diagnosis>, 2> surrogates;
  for (auto& seen : surrogates) {
    ++settings.seed;
    effect::Surrogate surrogate{settings};
    const auto again = std::make_unique<Estimator>(core);
    seen = std::make_unique<effect::Diagnosis>(core, diagnosis->grids());
    for (const Sample& s : samples) {
      const auto t = surrogate.next(s);
      if (t) seen->update(*t, again->update(*t));
    }
    seen->finish();
  }
  EXPECT_TRUE(explainer->apply_floor({*surrogates[0], surrogates[1].get()}, 0, e));
  out.truth = e.base.held_out_nmse;
  return out;
}

TEST(Floor, IsWhatACleanRecordLeaves) {
  const struct {
    sim::Load load;
    double noise_scale;
    double within;
  } cases[]{
      {sim::Load::kLaden, 1.0, 0.1}, {sim::Load::kEmpty, 1.0, 0.1}, {sim::Load::kLaden, 3.0, 0.15}};
  for (const auto& c : cases) {
    const Floor f = floor_of(c.load, 80.0, "", c.noise_scale);
    EXPECT_EQ(f.explanation.step_count, 0U);
    EXPECT_EQ(f.explanation.conclusion, effect::Conclusion::kComplete);
    EXPECT_NEAR(f.explanation.floor_nmse / f.truth, 1.0, c.within);
  }
}

TEST(Floor, TellsThatALawIsComplete) {
  const Floor f = floor_of(sim::Load::kLaden, 80.0, "cubic_stiffness", 1.0);
  ASSERT_EQ(f.explanation.step_count, 1U);
  EXPECT_LT(floor_ratio(f.explanation), effect::kIncompleteAbove);
  EXPECT_EQ(f.explanation.conclusion, effect::Conclusion::kExplained);
}

}  // namespace
}  // namespace dampline::app
