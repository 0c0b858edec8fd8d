// SPDX-License-Identifier: MIT
#include "dampline/guard/judgement_delay.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "dampline/damping/estimator.hpp"
#include "dampline/guard/spike_watch.hpp"
#include "sim_hw/faults.hpp"
#include "sim_hw/noise.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline {
namespace {

constexpr std::size_t kWait = 24 * 300;

struct Held {
  std::vector<Sample> in;
  std::vector<Sample> out;
  RepairCounts counts;
};

std::vector<Sample> record_of(double length_s, const sim::RecordFaultConfig& faults) {
  const auto simulation = sim::reference_run(sim::Load::kLaden, 80.0, 11);
  sim::FaultyRecord source{simulation, faults};
  std::vector<Sample> out;
  for (int i = 0; i < static_cast<int>(length_s * 300.0); ++i)
    out.push_back(sim::to_sample(source.next()));
  return out;
}

Held hold(std::vector<Sample> samples, std::size_t wait = kWait) {
  GuardConfig config;
  const auto simulation = sim::reference_run(sim::Load::kLaden, 80.0, 11);
  for (std::size_t c = 0; c < kChannels; ++c)
    config.step_mps2[c] = sim::count_scale_mps2(simulation.sensors.range_mps2[c]);
  const auto guard = std::make_unique<Guard>(config);
  const auto held = std::make_unique<JudgementDelay>(wait);
  Held result;
  Sample due;
  for (const Sample& sample : samples) {
    guard->update(sample);
    if (held->push(sample, *guard, due)) result.out.push_back(due);
  }
  guard->finish();
  while (held->drain(*guard, due)) result.out.push_back(due);
  result.in = std::move(samples);
  result.counts = held->counts();
  return result;
}

bool same(const Sample& a, const Sample& b) {
  return a.tick == b.tick && a.time_ns == b.time_ns && a.accel_mps2 == b.accel_mps2 &&
         a.saturated == b.saturated && a.spoilt == b.spoilt;
}

TEST(JudgementDelay, PassesSoundSamplesOnAsTheyAre) {
  for (const std::size_t wait : {std::size_t{0}, std::size_t{300}, kWait}) {
    const Held held = hold(record_of(60.0, {}), wait);
    ASSERT_EQ(held.out.size(), held.in.size());
    for (std::size_t i = 0; i < held.in.size(); ++i) ASSERT_TRUE(same(held.in[i], held.out[i]));
    EXPECT_EQ(held.counts.replaced + held.counts.spoilt, 0U);
  }
}

TEST(JudgementDelay, GivesOneSampleForEachOneWhateverTheTicks) {
  std::vector<Sample> samples = record_of(60.0, {});
  samples.erase(samples.begin() + 9000, samples.begin() + 15000);
  for (const std::size_t wait : {std::size_t{1}, std::size_t{600}}) {
    const auto guard = std::make_unique<Guard>(GuardConfig{});
    const auto held = std::make_unique<JudgementDelay>(wait);
    Sample due;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      guard->update(samples[i]);
      ASSERT_EQ(held->push(samples[i], *guard, due), i >= wait);
      if (i >= wait) {
        ASSERT_EQ(due.tick, samples[i - wait].tick);
      }
    }
  }
}

/// Against the record without the fault.
TEST(JudgementDelay, ReplacesWrongSamplesByWhatTheirNeighboursSay) {
  const std::vector<Sample> sound = record_of(120.0, {});
  std::vector<Sample> spiked = sound;
  const std::vector<std::size_t> places{7000, 12500, 18000, 23456, 30000};
  for (const std::size_t place : places) spiked[place].accel_mps2[1] += 30.0;
  const Held held = hold(spiked);
  ASSERT_EQ(held.out.size(), sound.size());
  EXPECT_EQ(held.counts.replaced, places.size());
  EXPECT_EQ(held.counts.spoilt, 0U);
  for (std::size_t i = 0; i < sound.size(); ++i)  // a tenth of a spike
    EXPECT_NEAR(held.out[i].accel_mps2[1], sound[i].accel_mps2[1], 3.0) << i;
}

TEST(JudgementDelay, LeavesOutAJumpOfTheZeroAndABurst) {
  sim::RecordFaultConfig faults;
  faults.start_s = 90.0;
  faults.end_s = 100.0;
  faults.dc_jump_mps2[0] = 1.0;
  const Held jump = hold(record_of(150.0, faults));
  faults.dc_jump_mps2[0] = 0.0;
  faults.burst_mps2[0] = 0.4;
  const Held burst = hold(record_of(180.0, faults));
  const auto spoilt = [](const Held& held, double time_s) {
    return held.out[static_cast<std::size_t>(time_s * 300.0)].spoilt;
  };
  EXPECT_TRUE(spoilt(jump, 90.0));
  EXPECT_FALSE(spoilt(jump, 80.0));
  EXPECT_FALSE(spoilt(jump, 100.0));
  EXPECT_TRUE(spoilt(burst, 95.0));
  EXPECT_FALSE(spoilt(burst, 60.0));
  EXPECT_FALSE(spoilt(burst, 140.0));
}

TEST(JudgementDelay, LeavesOutWhereSamplesWereLostOrRepeatedAndNotCounted) {
  sim::RecordFaultConfig lost;
  lost.start_s = 90.0;
  lost.lost_everywhere = 2;
  sim::RecordFaultConfig counted;
  counted.start_s = 90.0;
  counted.counted_lost = 2;
  EXPECT_GT(hold(record_of(150.0, lost)).counts.spoilt, 0U);
  EXPECT_EQ(hold(record_of(150.0, counted)).counts.spoilt, 0U) << "the ticks show it";
}

TEST(JudgementDelay, MakesAnEstimateFromARecordWithSpikes) {
  sim::RecordFaultConfig faults;
  faults.spikes[1] = 30;
  faults.spike_mps2 = 40.0;
  faults.record_s = 120.0;
  const auto coulomb_n = [](const std::vector<Sample>& samples) {
    const auto identifier = std::make_unique<Estimator>(EstimatorConfig{});
    for (const Sample& sample : samples) identifier->update(sample);
    identifier->finish();
    return identifier->snapshot().coulomb_n.value;
  };
  const Held held = hold(record_of(120.0, faults));
  const double sound_n = coulomb_n(record_of(120.0, {}));
  EXPECT_GT(std::abs(coulomb_n(held.in) / sound_n - 1.0), 0.01) << "the spikes do harm";
  EXPECT_NEAR(coulomb_n(held.out) / sound_n, 1.0, 0.003);
}

/// The segment of 2 s in which they would be judged never ends.
TEST(JudgementDelay, ReplacesWrongSamplesUpToTheEnd) {
  const std::vector<Sample> sound = record_of(60.0, {});
  std::vector<Sample> wrong = sound;
  const std::vector<std::size_t> places{sound.size() - 250, sound.size() - 100, sound.size() - 6};
  for (const std::size_t at : places) wrong[at].accel_mps2[1] += 40.0;
  const Held held = hold(wrong);
  ASSERT_EQ(held.out.size(), sound.size());
  EXPECT_EQ(held.counts.replaced, places.size());
  for (const std::size_t at : places)
    EXPECT_NEAR(held.out[at].accel_mps2[1], sound[at].accel_mps2[1], 4.0) << at;
}

TEST(Estimator, MakesNothingOfSpoiltSamples) {
  std::vector<Sample> samples = record_of(60.0, {});
  for (std::size_t i = 9000; i < 9300; ++i) {
    samples[i].spoilt = true;
    samples[i].accel_mps2.fill(50.0);
  }
  const auto identifier = std::make_unique<Estimator>(EstimatorConfig{});
  std::vector<std::int64_t> excluded;
  for (const Sample& sample : samples) {
    const UpdateResult result = identifier->update(sample);
    if (result.block_closed && result.block.status == BlockStatus::kExcludedSpoilt)
      excluded.push_back(result.block.first_tick);
    if (result.has_motion) {
      EXPECT_LT(std::abs(result.motion.frame_mps2), 40.0);
    }
  }
  EXPECT_EQ(excluded, std::vector<std::int64_t>{9000});
}

/// White noise has none, and impulses have their own.
TEST(ImpulsePower, TellsImpulsesFromNoise) {
  sim::Random random{5, sim::Stream::kFaults};
  ImpulsePower noise;
  ImpulsePower both;
  for (int i = 0; i < 3000; ++i) {
    const double x = 0.1 * random.normal();
    noise.update(x);
    both.update(x + (i % 40 == 0 ? 1.0 : 0.0));
  }
  EXPECT_LT(noise.take(), 0.1 * 0.01);
  const double impulses = 1.0 / 40.0;  // mean square
  EXPECT_NEAR(both.take() / impulses, 0.8, 0.25) << "their own median hides a part";
}

}  // namespace
}  // namespace dampline
