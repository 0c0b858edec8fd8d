// SPDX-License-Identifier: MIT
// The surrogate against closed forms, and the floor that it gives against clean records, whose
// error is the floor.
#include "dampline/effect/surrogate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <memory>

#include "dampline/effect/explainer.hpp"
#include "dampline/motion/frame_noise.hpp"
#include "sim_hw/effects/registry.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::app {
namespace {

constexpr double kRateHz = 300.0;

Sample sample_of(std::int64_t tick, double wheelset_mps2) {
  Sample s;
  s.tick = tick;
  s.accel_mps2 = {99.0, wheelset_mps2, wheelset_mps2};  // the frame's own is not looked at
  return s;
}

TEST(Surrogate, AnswersATonesAsALinearOscillatorDoes) {
  effect::SurrogateConfig config;
  config.stiffness_per_s2 = 141.4;
  config.viscous_per_s = 3.0;
  effect::Surrogate surrogate{config};
  const double w = 2.0 * M_PI * 2.3;
  // y'' + 2 c y' + 2 k y = -(a1 + a2); z_b'' = -(k y + c y')
  const std::complex<double> y = -2.0 / std::complex<double>{2.0 * 141.4 - w * w, 2.0 * 3.0 * w};
  const std::complex<double> expected = -y * std::complex<double>{141.4, 3.0 * w};
  double worst = 0.0;
  for (int n = 0; n < 6000; ++n) {
    const auto out = surrogate.next(sample_of(n, std::cos(w * n / kRateHz)));
    if (n < 3000 || !out) continue;
    const double t = static_cast<double>(out->tick) / kRateHz;
    const double truth = (expected * std::polar(1.0, w * t)).real();
    worst = std::max(worst, std::abs(out->accel_mps2[0] - truth));
    EXPECT_NEAR(out->accel_mps2[1], std::cos(w * t), 1e-9);
  }
  EXPECT_LT(worst, 1e-3 * std::abs(expected));
}

TEST(Surrogate, SticksUntilTheInputBreaksItLoose) {
  effect::SurrogateConfig config;
  config.stiffness_per_s2 = 141.4;
  config.coulomb_mps2 = 0.5;
  effect::Surrogate surrogate{config};
  // Below the break-away level the frame follows the wheelsets: z_b'' = (z_1'' + z_2'') / 2.
  double last = 0.0;
  for (int n = 0; n < 900; ++n) {
    const auto out = surrogate.next(sample_of(n, 0.3 * std::sin(2.0 * M_PI * 3.0 * n / kRateHz)));
    if (out) last = out->accel_mps2[0] - out->accel_mps2[1];
    if (n <= 300) continue;
    EXPECT_NEAR(last, 0.0, 0.02);
  }
}

TEST(Surrogate, HasTheNoiseAndTheResolutionOfTheSensors) {
  effect::SurrogateConfig config;
  config.stiffness_per_s2 = 141.4;
  config.noise_mps2 = {0.03, 0.03, 0.03};
  config.step_mps2 = {0.02, 0.02, 0.02};
  effect::Surrogate surrogate{config};
  double squares = 0.0;
  int count = 0;
  for (int n = 0; n < 20000; ++n) {
    const auto out = surrogate.next(sample_of(n, 0.0));
    if (!out) continue;
    const double codes = out->accel_mps2[1] / 0.02;
    EXPECT_NEAR(codes, std::round(codes), 1e-9);
    squares += out->accel_mps2[1] * out->accel_mps2[1];
    ++count;
  }
  EXPECT_NEAR(std::sqrt(squares / count), 0.03, 0.001);
}

TEST(Surrogate, KeepsGapsAndWhatIsNoNumber) {
  effect::Surrogate surrogate{effect::SurrogateConfig{.stiffness_per_s2 = 141.4}};
  int made = 0;
  for (int n = 0; n < 120; ++n) {
    const bool bad = n == 60;
    const auto out =
        surrogate.next(sample_of(n, bad ? std::numeric_limits<double>::quiet_NaN() : 0.1 * n));
    if (!out) continue;
    EXPECT_EQ(std::isnan(out->accel_mps2[1]), bad);
    EXPECT_TRUE(out->tick <= 36 || out->tick == 60 || out->tick >= 85) << out->tick;
    ++made;
  }
  EXPECT_EQ(made, 13 + 1 + 12);  // 24 samples to either side of what is between two
}

TEST(Surrogate, BuildsItsFrictionUpOverDahlsLength) {
  effect::SurrogateConfig config;
  config.stiffness_per_s2 = 141.4;
  config.memory = {false, 0.4, 0.6e-3};
  effect::Surrogate surrogate{config};
  // A slow tone, so that 2 z_b'' = input + y'' and the loop of f(y) is Dahl's closed form:
  // f = +-F (1 - c e^(-+(y - y_r) / r)) from a reversal at y_r with f = f_r.
  double y = 0.0;
  double v = 0.0;
  double zeta = 0.0;
  double worst = 0.0;
  const double step_s = 1.0 / (kRateHz * 400.0);
  const double w = 2.0 * M_PI * 1.3;
  const auto input = [&](double t) { return 0.8 * std::sin(w * t) * std::min(1.0, t); };
  std::vector<double> truth;
  for (int n = 0; n < 400 * 2400; ++n) {
    if (n % 400 == 0) truth.push_back(-141.4 * y - 0.4 * zeta);
    const double a = 2.0 * (-141.4 * y - 0.4 * zeta) - 2.0 * input(step_s * n);
    v += step_s * a;
    const double way_m = step_s * v;
    const double towards = way_m < 0.0 ? -1.0 : 1.0;
    zeta = towards + (zeta - towards) * std::exp(-std::abs(way_m) / 0.6e-3);
    y += way_m;
  }
  for (int n = 0; n < 2399; ++n) {
    const auto out = surrogate.next(sample_of(n, input(n / kRateHz)));
    if (!out || n < 300) continue;
    worst =
        std::max(worst, std::abs(out->accel_mps2[0] - truth[static_cast<std::size_t>(out->tick)]));
  }
  EXPECT_LT(worst, 0.01);
}

TEST(Surrogate, HasNoFrictionInsideItsPlay) {
  effect::SurrogateConfig config;
  config.stiffness_per_s2 = 141.4;
  config.memory = {true, 0.4, 4e-3};
  effect::Surrogate surrogate{config};
  const double w = 2.0 * M_PI * 1.0;
  // 1.2 mm of deflection stay inside the gap: the spring alone answers, so nothing damps.
  const double amplitude = 0.08;
  double peak = 0.0;
  for (int n = 0; n < 3000; ++n) {
    const auto out = surrogate.next(sample_of(n, amplitude * std::sin(w * n / kRateHz)));
    if (out && n > 2000) peak = std::max(peak, std::abs(out->accel_mps2[0]));
  }
  const double forced = amplitude * 2.0 * 141.4 / (2.0 * 141.4 - w * w);
  EXPECT_GT(peak, forced);  // what the start set swinging goes on
  EXPECT_LT(peak, 0.4);
  // 5 times as much takes the gap up, and friction damps.
  effect::Surrogate struck{config};
  double least = 1e9;
  for (int n = 0; n < 3000; ++n) {
    const auto out = struck.next(sample_of(n, n < 300 ? 2.0 * std::sin(w * n / kRateHz) : 0.0));
    if (out && n > 2700) least = std::min(least, std::abs(out->accel_mps2[0]));
    if (out && n > 2700) peak = std::max(peak, std::abs(out->accel_mps2[0]));
  }
  EXPECT_LT(peak, 141.4 * 2.0e-3 + 0.05);  // the free swing that is left fits into the gap
}

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
  for (int n = 0; n < 3000; ++n) noise.take(sample_of(n, 0.0));
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
  settings.anti_alias_hz = core.anti_alias.corner_hz;
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
