// SPDX-License-Identifier: MIT
#include "dampline/guard/guard.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "sim_hw/effects/registry.hpp"
#include "sim_hw/faults.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline {
namespace {

using ::testing::Contains;
using ::testing::IsEmpty;

struct Trial {
  sim::SimulationConfig simulation = sim::reference_run(sim::Load::kLaden, 80.0, 1);
  sim::RecordFaultConfig faults;
  GuardConfig guard;
  double length_s{150.0};
  bool step_is_declared{true};
};

std::unique_ptr<Guard> run(const std::function<void(Trial&)>& change) {
  Trial s;
  s.faults.start_s = 80.0;
  s.faults.end_s = 95.0;
  s.faults.record_s = s.length_s;
  s.guard.wheelbase_m = s.simulation.truck.wheelbase_m;
  s.guard.speed_mps = s.simulation.speed.speed_mps;
  s.guard.leading = Leading::kWheelset1;
  s.guard.noise_mps2.fill(s.simulation.sensors.noise_mps2);
  change(s);
  for (std::size_t c = 0; s.step_is_declared && c < kChannels; ++c) {
    s.guard.step_mps2[c] = sim::count_scale_mps2(s.simulation.sensors.range_mps2[c]);
  }
  auto guard = std::make_unique<Guard>(Guard::check(s.guard).value());
  sim::FaultyRecord record{s.simulation, s.faults};
  const auto samples = static_cast<int>(s.length_s * sim::kSampleRateHz);
  for (int i = 0; i < samples; ++i) guard->update(sim::to_sample(record.next()));
  guard->finish();
  return guard;
}

/// "name channel" of every fault.
std::vector<std::string> names(const Guard& guard) {
  std::vector<std::string> all;
  for (const Fault& fault : guard.faults()) {
    all.push_back(std::string{name_of(fault.kind)} + " " + name_of(fault.channel));
  }
  return all;
}

using Names = std::vector<std::string>;

const Fault& only(const Guard& guard) {
  EXPECT_EQ(guard.faults().size(), 1U) << ::testing::PrintToString(names(guard));
  static const Fault kNone{};
  return guard.faults().empty() ? kNone : guard.faults().front();
}

TEST(Guard, KnowsAChannelThatIsACopyOfAnother) {
  for (const auto& [copy, of, channel] : {std::tuple{2U, 1U, "identical_channels wheelsets"},
                                          std::tuple{0U, 1U, "identical_channels all"},
                                          std::tuple{2U, 0U, "identical_channels all"}}) {
    Guard guard{GuardConfig{}};
    sim::Simulation simulation{sim::reference_run(sim::Load::kEmpty, 60.0, 3)};
    for (int i = 0; i < 30 * sim::kSampleRateHz; ++i) {
      Sample sample = sim::to_sample(simulation.next());
      sample.accel_mps2[copy] = sample.accel_mps2[of];
      guard.update(sample);
    }
    guard.finish();
    EXPECT_THAT(names(guard), Contains(channel));
  }
}

TEST(Guard, FindsNothingInCleanRecordsOfThreeCars) {
  for (const std::uint64_t seed : {101U, 102U}) {
    for (const auto& [load, speed] :
         {std::pair{sim::Load::kLaden, 80.0}, std::pair{sim::Load::kLaden, 60.0},
          std::pair{sim::Load::kEmpty, 80.0}}) {
      const auto guard = run([&, l = load, v = speed](Trial& s) {
        s.simulation = sim::reference_run(l, v, seed);
        s.guard.speed_mps = v / 3.6;
      });
      EXPECT_THAT(names(*guard), IsEmpty());
      EXPECT_GT(guard->block().coherent_share, 0.9);  // the tests did run
    }
  }
}

TEST(Guard, TakesNoEffectOfTheSuspensionForAFault) {
  for (const char* effect : {"bump_stop", "presliding_hysteresis", "unmodelled_mode", "backlash"}) {
    const auto guard =
        run([&](Trial& s) { ASSERT_FALSE(sim::add_effect(s.simulation, effect, {})); });
    EXPECT_THAT(names(*guard), IsEmpty()) << effect;
  }
}

TEST(Guard, NamesALostSampleAndItsChannel) {
  for (std::size_t c = 0; c < kChannels; ++c) {
    const auto guard = run([c](Trial& s) { s.faults.lost_samples[c] = 1; });
    const Fault& fault = only(*guard);
    EXPECT_STREQ(name_of(fault.kind), "lost_samples");
    EXPECT_EQ(fault.channel, channel_of(c));
    EXPECT_EQ(fault.size, 1.0);
    EXPECT_NEAR(fault.time_s, 80.0, 10.0);
  }
}

TEST(Guard, MeasuresATimingStep) {
  const auto guard = run([](Trial& s) { s.faults.delay_step_s[2] = 0.002; });
  const Fault& fault = only(*guard);
  EXPECT_STREQ(name_of(fault.kind), "timing_step");
  EXPECT_EQ(fault.channel, FaultChannel::kWheelset2);
  EXPECT_NEAR(fault.size, 0.002, 20e-6);
}

TEST(Guard, MeasuresTheDriftOfAClock) {
  for (std::size_t c = 0; c < kChannels; ++c) {
    const auto guard = run([c](Trial& s) { s.faults.clock_drift_ppm[c] = 50.0; });
    const Fault& fault = only(*guard);
    EXPECT_STREQ(name_of(fault.kind), "clock_drift");
    EXPECT_EQ(fault.channel, channel_of(c));
    EXPECT_NEAR(fault.size, 50.0, 5.0);
  }
}

// By some 7 % the frame's lag behind one wheelset slips a period, and seems to follow.
TEST(Guard, TellsAChangeOfSpeedFromATimingFault) {
  for (const double factor : {0.88, 0.93, 0.96, 1.04, 1.07, 1.08, 1.1}) {
    const auto guard = run([factor](Trial& s) {
      s.guard.speed_mps = 0.0;
      s.simulation.speed.change_time_s = 70.0;
      s.simulation.speed.changed_speed_mps = factor * s.simulation.speed.speed_mps;
      s.simulation.speed.ramp_mps2 = 0.1;
    });
    EXPECT_THAT(names(*guard), IsEmpty()) << factor;
    EXPECT_GE(guard->inputs().speed_changes, 1U) << factor;
  }
}

// Friction holds the frame for another share of the time at another speed, so that its lag changes.
TEST(Guard, TakesBrakingForARide) {
  for (const double factor : {0.8, 0.65, 0.45}) {
    for (const std::uint64_t seed : {1U, 2U, 4U}) {
      const auto guard = run([&](Trial& s) {
        s.simulation.seed = seed;
        s.length_s = 240.0;
        s.guard.speed_mps = 0.0;
        s.simulation.speed.change_time_s = 100.0;
        s.simulation.speed.changed_speed_mps = factor * s.simulation.speed.speed_mps;
      });
      EXPECT_THAT(names(*guard), IsEmpty()) << factor << " seed " << seed;
      EXPECT_EQ(guard->inputs().speed_changes, 1U) << factor << " seed " << seed;
    }
  }
}

TEST(Guard, TakesAStopForARide) {
  for (const std::uint64_t seed : {2U, 3U, 5U}) {
    const auto guard = run([&](Trial& s) {
      s.simulation.seed = seed;
      s.length_s = 240.0;
      s.guard.speed_mps = 0.0;
      s.simulation.speed.standstills[0] = {120.0, 140.0};
    });
    EXPECT_THAT(names(*guard), IsEmpty()) << seed;
  }
}

TEST(Guard, NamesALooseCable) {
  for (std::size_t c = 0; c < kChannels; ++c) {
    const auto guard = run([c](Trial& s) { s.faults.opens_hz[c] = 2.0; });
    const Fault& fault = only(*guard);
    EXPECT_STREQ(name_of(fault.kind), "stuck_channel");
    EXPECT_EQ(fault.channel, channel_of(c));
    EXPECT_NEAR(fault.time_s, 80.0, 5.0);
    EXPECT_LE(fault.size, 0.2);
    EXPECT_GT(fault.count, 5U);
  }
}

TEST(Guard, MeasuresAGainStep) {
  const auto guard = run([](Trial& s) { s.faults.gain_step[1] = 0.03; });
  const Fault& fault = only(*guard);
  EXPECT_STREQ(name_of(fault.kind), "gain_change");
  EXPECT_NEAR(fault.size, 3.0, 0.5);
}

TEST(Guard, LearnsTheResolutionThatNobodyDeclared) {
  EXPECT_THAT(names(*run([](Trial& s) { s.step_is_declared = false; })), IsEmpty());
  EXPECT_THAT(names(*run([](Trial& s) {
                s.step_is_declared = false;
                s.simulation.sensors.limit_mps2[1] = 5.0;
              })),
              Contains("clipping wheelset1"));
}

TEST(Guard, NamesWhatIsWrongWithTheCodesOfAChannel) {
  EXPECT_THAT(names(*run([](Trial& s) { s.simulation.sensors.limit_mps2[1] = 5.0; })),
              Contains("clipping wheelset1"));
  EXPECT_THAT(names(*run([](Trial& s) {
                s.simulation.sensors.stuck_start_s[2] = 60.0;
                s.simulation.sensors.stuck_end_s[2] = 60.5;
              })),
              Names{"stuck_channel wheelset2"});
  EXPECT_THAT(names(*run([](Trial& s) { s.faults.lost_bits[0] = 2; })),
              Names{"resolution_loss frame"});
  EXPECT_THAT(names(*run([](Trial& s) { s.faults.spikes[1] = 8; })), Names{"spikes wheelset1"});
}

TEST(Guard, MeasuresAJumpOfTheZero) {
  const auto guard = run([](Trial& s) { s.faults.dc_jump_mps2[0] = -0.5; });
  const Fault& fault = only(*guard);
  EXPECT_STREQ(name_of(fault.kind), "dc_jump");
  EXPECT_EQ(fault.channel, FaultChannel::kFrame);
  EXPECT_NEAR(fault.size, -0.5, 0.1);
  EXPECT_NEAR(fault.time_s, 80.0, 1.5);
}

TEST(Guard, NamesSamplesLostOrRepeatedInAllChannels) {
  const auto slip = run([](Trial& s) { s.faults.lost_everywhere = 1; });
  EXPECT_THAT(names(*slip), Names{"lost_samples all"});
  EXPECT_NEAR(slip->faults().front().time_s, 80.0, 1.0);
  const auto counted = run([](Trial& s) { s.faults.counted_lost = 7; });
  EXPECT_THAT(names(*counted), Names{"lost_samples all"});
  EXPECT_EQ(counted->faults().front().size, 7.0);
  EXPECT_THAT(names(*run([](Trial& s) { s.faults.repeated_everywhere = 6; })),
              Names{"repeated_samples all"});
  const auto codes_alone = run([](Trial& s) {
    s.faults.repeated_everywhere = 14;
    s.guard.wheelbase_m = 0.0;  // what the wheelsets' distance tells comes sooner
  });
  EXPECT_EQ(names(*codes_alone).front(), "repeated_samples all");
  EXPECT_NEAR(codes_alone->faults().front().time_s, 81.6, 0.1) << "the first of them, not the last";
}

// A tenth of the wheelsets' power is not shared.
// A line is drawn across eight samples, whatever gravity adds to them; no block is made across it.
TEST(Guard, ManyShortGapsAreLostSamplesAlone) {
  for (const int missing : {1, 8}) {
    sim::Simulation simulation{sim::reference_run(sim::Load::kLaden, 80.0, 1)};
    const auto guard = std::make_unique<Guard>(GuardConfig{});
    for (int i = 0; i < 100 * sim::kSampleRateHz; ++i) {
      Sample sample = sim::to_sample(simulation.next());
      for (double& accel : sample.accel_mps2) accel += 9.81;
      if (i < 15'000 || i % 300 >= missing) guard->update(sample);
    }
    guard->finish();
    EXPECT_EQ(names(*guard), Names{"lost_samples all"});
    EXPECT_NEAR(guard->block().delay_s, 1.8 / (80.0 / 3.6), 1e-4);
    EXPECT_LT(guard->block().last_tick, 15'000) << missing;
  }
}

// One that ticks miss at 30 s, and one in all channels that none misses at 80 s.
TEST(Guard, SeesASlipBehindAGap) {
  const sim::SimulationConfig simulation = sim::reference_run(sim::Load::kLaden, 80.0, 1);
  sim::FaultyRecord record{simulation, {.start_s = 80.0, .end_s = 95.0, .lost_everywhere = 1}};
  const auto guard = std::make_unique<Guard>(GuardConfig{});
  for (int i = 0; i < 150 * sim::kSampleRateHz; ++i) {
    const Sample sample = sim::to_sample(record.next());
    if (i != 9000) guard->update(sample);
  }
  EXPECT_EQ(names(*guard), Names{"lost_samples all"});
  EXPECT_EQ(guard->faults().front().count, 2U);
  EXPECT_NEAR(guard->faults().front().last_s, 80.0, 1.0);
}

TEST(Guard, NamesSamplesLostInAllChannelsWhereWheelsetsDiffer) {
  const auto with = [](int lost) {
    return run([lost](Trial& s) {
      s.simulation = sim::reference_run(sim::Load::kLaden, 80.0, 2);
      s.simulation.incoherent_power = 0.1;
      s.faults.lost_everywhere = lost;
    });
  };
  const auto guard = with(2);
  const Fault& fault = only(*guard);
  EXPECT_STREQ(name_of(fault.kind), "lost_samples");
  EXPECT_EQ(fault.channel, FaultChannel::kAll);
  EXPECT_EQ(fault.size, 2.0);
  EXPECT_NEAR(fault.time_s, 80.0, 0.1);
  EXPECT_NE(guard->spoilt(80 * 300, 80 * 300) & 1U << static_cast<unsigned>(fault.kind), 0U);
  EXPECT_THAT(names(*with(0)), IsEmpty());
}

TEST(Guard, NamesExchangedAndInvertedSensors) {
  EXPECT_THAT(names(*run([](Trial& s) {
                s.simulation.sensors.range_mps2.fill(98.0665);
                s.faults.source = {1, 0, 2};
              })),
              Names{"swapped_channels all"});
  EXPECT_THAT(names(*run([](Trial& s) {
                s.faults.source = {0, 2, 1};
              })),
              Contains("swapped_channels wheelsets"));
  for (std::size_t c = 0; c < kChannels; ++c) {
    const auto guard = run([c](Trial& s) { s.faults.inverted[c] = true; });
    EXPECT_THAT(names(*guard), Names{std::string{"wrong_polarity "} + name_of(channel_of(c))});
  }
}

// Worn out and on soft springs a truck resonates at 1.6 or 1.8 Hz, above which it moves against the
// track.
TEST(Guard, TakesAResonanceForNoSensorUpsideDown) {
  const auto worn = [](double stiffness_npm, bool inverted) {
    return names(*run([&](Trial& s) {
      s.simulation.truck.stiffness_npm = stiffness_npm;
      s.simulation.truck.friction_scale = 0.1;
      s.faults.inverted[0] = inverted;
    }));
  };
  EXPECT_THAT(worn(1.9e6, false), IsEmpty());
  EXPECT_THAT(worn(2.5e6, false), IsEmpty());
  EXPECT_THAT(worn(2.5e6, true), Contains("wrong_polarity frame"));
}

TEST(Guard, NamesNoiseAndItsBursts) {
  EXPECT_THAT(names(*run([](Trial& s) { s.faults.noise_mps2[0] = 0.08; })),
              Names{"excess_noise frame"});
  const auto guard = run([](Trial& s) { s.faults.burst_mps2[0] = 0.3; });
  EXPECT_THAT(names(*guard), Contains("noise_burst frame"));
  EXPECT_NE(guard->spoilt(85 * 300, 90 * 300), 0U);
  EXPECT_EQ(guard->spoilt(20 * 300, 50 * 300), 0U);
}

// The frame's fast power scatters from block to block where friction holds it.
TEST(Guard, TakesTheScatterOfABlockForNoBurst) {
  const auto guard = run([](Trial& s) {
    s.length_s = 75.0;
    s.simulation = sim::reference_run(sim::Load::kLaden, 60.0, 9122);
    ASSERT_FALSE(sim::add_effect(s.simulation, "stribeck", {{"strength", 1.0294}}));
    s.guard.speed_mps = 0.0;
    s.guard.noise_mps2.fill(0.0);  // not declared
  });
  EXPECT_THAT(names(*guard), IsEmpty());
}

TEST(Guard, NamesASensorThatSaturates) {
  const auto guard = run([](Trial& s) { s.faults.saturation_mps2[2] = 12.0; });
  EXPECT_THAT(names(*guard), Contains("soft_saturation wheelset2"));
}

TEST(Guard, NamesAWrongRate) {
  const auto guard = run([](Trial& s) { s.guard.speed_mps *= 1.015; });
  const Fault& fault = only(*guard);
  EXPECT_STREQ(name_of(fault.kind), "wrong_sample_rate");
  EXPECT_NEAR(fault.size, 304.5, 0.5);
}

TEST(Guard, RefusesWhatCannotBe) {
  GuardConfig config;
  config.sample_rate_hz = 0.0;
  EXPECT_FALSE(Guard::check(config).ok());
  config = {};
  config.step_mps2[1] = -1.0;
  EXPECT_FALSE(Guard::check(config).ok());
}

// Codes get their unit when the first ten seconds are over.
TEST(Guard, MeasuresSpikesOfTheFirstSecondsInTheirOwnUnit) {
  const auto guard = run([](Trial& s) {
    s.step_is_declared = false;
    s.length_s = 40.0;
    s.faults.spikes[1] = 8;
    s.faults.record_s = 9.0;
  });
  ASSERT_THAT(names(*guard), Contains("spikes wheelset1"));
  for (const Fault& fault : guard->faults())
    if (fault.kind == FaultKind::kSpikes) {
      EXPECT_NEAR(std::abs(fault.size), 20.0, 8.0);
    }
}

TEST(Guard, NamesJitterAndItsSize) {
  for (const double jitter_s : {1e-4, 4e-4}) {
    const auto guard = run([&](Trial& s) { s.faults.jitter_s.fill(jitter_s); });
    const Names all = names(*guard);
    ASSERT_THAT(all, Contains("jitter wheelsets")) << jitter_s;
    for (const Fault& fault : guard->faults())
      if (fault.kind == FaultKind::kJitter) {
        EXPECT_NEAR(fault.size / jitter_s, 1.0, 0.3);
      }
  }
}

TEST(Guard, TakesWheelsThatDifferForNoJitter) {
  for (const double power : {0.01, 0.1}) {
    const auto guard = run([&](Trial& s) { s.simulation.incoherent_power = power; });
    EXPECT_THAT(names(*guard), ::testing::Not(Contains("jitter wheelsets"))) << power;
  }
}

TEST(Guard, TakesCantForNoJumpOfTheZero) {
  const auto guard = run([](Trial& s) {
    s.faults.dc_jump_mps2.fill(0.6);
    s.faults.dc_jump_time_s = 3.0;
  });
  EXPECT_THAT(names(*guard), IsEmpty());
}

TEST(Guard, TakesSlowMotionForNoRepetition) {
  const auto guard = run([](Trial& s) {
    s.simulation.track.short_wave_mps2 = 0.0;
    s.simulation.sensors.noise_mps2 = 0.008;
  });
  EXPECT_THAT(names(*guard), ::testing::Not(Contains("repeated_samples all")));
}

}  // namespace
}  // namespace dampline
