// SPDX-License-Identifier: MIT
#include "dampline/sample/placer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "dampline/identifier.hpp"
#include "sim_hw/faults.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline {
namespace {

constexpr int kSamples = 60 * sim::kSampleRateHz;

/// A laden ride whose sampling instants are off by so much, rms.
std::vector<Sample> ride(double jitter_s, bool stamped, int samples = kSamples) {
  sim::RecordFaultConfig faults;
  faults.jitter_s.fill(jitter_s);
  faults.jitter_is_stamped = stamped;
  sim::FaultyRecord record{sim::reference_run(sim::Load::kLaden, 80.0, 3), faults};
  std::vector<Sample> out;
  for (int i = 0; i < samples; ++i) {
    static_cast<void>(record.next());
    out.push_back(record.stamped());
  }
  return out;
}

struct Placed {
  std::vector<Sample> taken, placed;
  PlacedFigures figures;
};
Placed place(const std::vector<Sample>& samples) {
  const auto placer = std::make_unique<SamplePlacer>(300.0);
  Placed out;
  const auto take = [&] {
    for (Sample taken, placed; placer->pop(taken, placed);) {
      out.taken.push_back(taken);
      out.placed.push_back(placed);
    }
  };
  for (const Sample& sample : samples) {
    placer->push(sample);
    take();
  }
  placer->finish();
  take();
  out.figures = placer->figures();
  return out;
}

double rms_difference(const std::vector<Sample>& a, const std::vector<Sample>& b, std::size_t c,
                      std::size_t first, std::size_t last) {
  double sum = 0.0;
  for (std::size_t i = first; i < last; ++i)
    sum += std::pow(a[i].accel_mps2[c] - b[i].accel_mps2[c], 2);
  return std::sqrt(sum / static_cast<double>(last - first));
}

void expect_untouched(const std::vector<Sample>& samples) {
  const Placed out = place(samples);
  ASSERT_EQ(out.placed.size(), samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i)
    ASSERT_EQ(out.placed[i].accel_mps2, samples[i].accel_mps2) << i;
  for (const double off_s : out.figures.off_s) EXPECT_EQ(off_s, 0.0);
}

TEST(SamplePlacer, HandsOnAtOnceWhatHasNoStampsOfItsOwn) {
  SamplePlacer placer{300.0};
  for (const Sample& sample : ride(0.0, false, 3000)) {
    placer.push(sample);
    Sample taken, placed;
    ASSERT_TRUE(placer.pop(taken, placed));
    ASSERT_EQ(placed.tick, sample.tick);
    ASSERT_EQ(placed.accel_mps2, sample.accel_mps2);
    ASSERT_FALSE(placer.pop(taken, placed));
  }
}

// The way of a frame, rounded times, stamps that are not there: none of them moves a sample.
TEST(SamplePlacer, LeavesSamplesWhoseStampsTellNothingOfThem) {
  expect_untouched(ride(4e-4, false));
  std::mt19937_64 random{5};
  std::normal_distribution<double> late{0.0, 400.0};  // us
  auto busy = ride(0.0, false);
  for (Sample& sample : busy) {
    sample.time_ns += std::llround(1e3 * late(random));
    for (auto& after_us : sample.wheelset_after_us)
      after_us = static_cast<std::int16_t>(late(random));
  }
  expect_untouched(busy);
  auto rounded = ride(0.0, false);
  for (Sample& sample : rounded)
    sample.time_ns = (sample.time_ns + 500'000) / 1'000'000 * 1'000'000;
  expect_untouched(rounded);
}

TEST(SamplePlacer, PutsSamplesAtTheTimesOfTheirStamps) {
  const auto even = ride(0.0, false);
  for (const double jitter_s : {1e-4, 4e-4}) {
    const auto taken = ride(jitter_s, true);
    const Placed out = place(taken);
    ASSERT_EQ(out.placed.size(), taken.size());
    for (std::size_t c = 0; c < kChannels; ++c) {
      const double before = rms_difference(taken, even, c, 1500, taken.size() - 100);
      const double after = rms_difference(out.placed, even, c, 1500, taken.size() - 100);
      // A code's rounding is left, which `even` has as well.
      const double code = c == 0 ? 0.024 : 0.048;
      EXPECT_LT(after, 0.06 * before + 0.45 * code) << c << ' ' << jitter_s << ' ' << before;
      if (c > 0) {
        EXPECT_NEAR(out.figures.off_s[c] / jitter_s, 1.0, 0.05) << c;
      }
    }
  }
}

TEST(SamplePlacer, KeepsTicksAndLosesNothingAcrossGaps) {
  auto samples = ride(4e-4, true);
  samples.erase(samples.begin() + 9000, samples.begin() + 9007);
  samples.erase(samples.begin() + 12'000, samples.begin() + 15'000);
  const Placed out = place(samples);
  ASSERT_EQ(out.placed.size(), samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    ASSERT_EQ(out.placed[i].tick, samples[i].tick);
    ASSERT_EQ(out.taken[i].accel_mps2, samples[i].accel_mps2);
    for (const double a : out.placed[i].accel_mps2) ASSERT_LT(std::abs(a), 60.0);
  }
}

TEST(SamplePlacer, MakesStampedJitterAsGoodAsNone) {
  const auto level_of = [](double jitter_s, bool stamped) {
    const auto core = std::make_unique<EmbeddedIdentifier>(
        IdentifierConfig{.estimator = {.sample_rate_hz = 300.0, .moving_mass_kg = 37200.0}});
    for (const Sample& sample : ride(jitter_s, stamped, 100 * sim::kSampleRateHz))
      core->push(sample);
    core->finish();
    const FaultView faults = core->faults();
    for (const Fault& fault : faults.list())
      EXPECT_EQ(stamped, fault.kind != FaultKind::kJitter) << name_of(fault.kind);
    return core->snapshot().coulomb_n;
  };
  const Estimate even = level_of(0.0, true);
  EXPECT_NEAR(level_of(4e-4, true).value, even.value, 0.7 * even.std);
  EXPECT_GT(level_of(4e-4, false).value, even.value + 4.0 * even.std);
}

/// Tones at instants that are off the even ones by so much, which the stamps say or not.
struct UnevenTones {
  double off_s{1e-4};
  bool is_stamped{true};
  double noise_mps2{1e-3};
  int samples{20 * 300};

  static double value(double t, std::size_t c) {
    const double phase = 0.7 * static_cast<double>(c);
    return 3.0 * std::sin(40.0 * t + phase) + 2.0 * std::cos(233.0 * t) +
           std::sin(411.0 * t + 2.0 * phase);
  }
  [[nodiscard]] std::vector<Sample> record() const {
    std::mt19937 random{17};
    std::normal_distribution<double> normal;
    std::vector<Sample> out;
    for (int i = 0; i < samples; ++i) {
      Sample sample{.tick = i};
      std::array<std::int64_t, kChannels> stamp_ns{};
      for (std::size_t c = 0; c < kChannels; ++c) {
        const double off = off_s * normal(random);
        const double told = is_stamped ? off : off_s * normal(random);
        sample.accel_mps2[c] = value(i / 300.0 + off, c) + noise_mps2 * normal(random);
        stamp_ns[c] = std::llround(1e9 * (i / 300.0 + told) + 1e6);
      }
      sample.time_ns = stamp_ns[0];
      for (std::size_t w = 0; w < 2; ++w)
        sample.wheelset_after_us[w] = static_cast<std::int16_t>(
            std::llround(1e-3 * static_cast<double>(stamp_ns[w + 1] - stamp_ns[0])));
      out.push_back(sample);
    }
    return out;
  }
};

double rms_off(const std::vector<Sample>& samples, std::size_t c, std::size_t first,
               std::size_t last) {
  double sum = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    const double truth = UnevenTones::value(static_cast<double>(samples[i].tick) / 300.0, c);
    sum += std::pow(samples[i].accel_mps2[c] - truth, 2);
  }
  return std::sqrt(sum / static_cast<double>(last - first));
}

TEST(SamplePlacer, PutsTonesWhereTheyBelong) {
  const UnevenTones tones{.off_s = 3e-4};
  const Placed out = place(tones.record());
  ASSERT_EQ(out.placed.size(), 6000U);
  for (std::size_t c = 0; c < kChannels; ++c) {
    EXPECT_GT(rms_off(out.taken, c, 3000, 5900), 0.08);
    EXPECT_LT(rms_off(out.placed, c, 3000, 5900), 0.008) << c;
    EXPECT_NEAR(out.figures.off_s[c] / 3e-4, 1.0, 0.05);
  }
}

TEST(SamplePlacer, PutsSmallTonesWhereTheyBelong) {
  auto record = UnevenTones{.off_s = 3e-4}.record();
  for (Sample& sample : record)
    for (double& a : sample.accel_mps2) a *= 1e-8;
  const Placed out = place(record);
  for (const double off_s : out.figures.off_s) EXPECT_NEAR(off_s / 3e-4, 1.0, 0.05);
}

// Stamps that leap by two ticks are another tick's until 32 samples in a row have shown that they
// stay there; the next one begins a new line, and those after it are put in their places again.
TEST(SamplePlacer, FollowsStampsThatLeap) {
  constexpr std::size_t kLeap = 4000;
  auto record = UnevenTones{.off_s = 3e-4}.record();
  for (std::size_t i = kLeap; i < record.size(); ++i) record[i].wheelset_after_us[0] += 6667;
  const Placed out = place(record);
  for (std::size_t i = kLeap - 20; i < kLeap + 80; ++i) {
    const bool stays = i >= kLeap && i <= kLeap + 32;
    EXPECT_EQ(out.placed[i].accel_mps2[1] == out.taken[i].accel_mps2[1], stays) << i - kLeap;
  }
}

TEST(SamplePlacer, LeavesTonesWhoseStampsTellNothing) {
  const Placed out = place(UnevenTones{.off_s = 3e-4, .is_stamped = false}.record());
  for (std::size_t i = 0; i < out.taken.size(); ++i)
    ASSERT_EQ(out.placed[i].accel_mps2, out.taken[i].accel_mps2);
  for (const double off_s : out.figures.off_s) EXPECT_EQ(off_s, 0.0);
}

// 20 us rms: what is less is how stamps are rounded.
TEST(SamplePlacer, PutsNothingThatIsLessThanTwentyMicrosecondsOff) {
  for (const auto& [off_s, placed] : {std::pair{17e-6, false}, std::pair{25e-6, true}}) {
    const Placed out = place(UnevenTones{.off_s = off_s, .noise_mps2 = 0.0}.record());
    EXPECT_EQ(out.figures.off_s[0] > 0.0, placed) << off_s;
  }
}

// Thirty-six samples wait once one is put anywhere; none before.
TEST(SamplePlacer, WaitsWhereItPlaces) {
  const auto record = UnevenTones{.off_s = 3e-4}.record();
  SamplePlacer placer{300.0};
  Sample taken;
  Sample placed;
  std::size_t out = 0;
  for (std::size_t i = 0; i < record.size(); ++i) {
    placer.push(record[i]);
    while (placer.pop(taken, placed)) ++out;
    if (i != 200) continue;
    EXPECT_EQ(out, 201U);
  }
  EXPECT_EQ(record.size() - out, 36U);
  placer.finish();
  while (placer.pop(taken, placed)) ++out;
  EXPECT_EQ(out, record.size());
}

TEST(SamplePlacer, LeavesWhatHasNoNeighboursOrStoodAtFullScaleOrWasPutIn) {
  auto record = UnevenTones{.off_s = 3e-4}.record();
  record[4000].saturated = 0b010;
  record[4100].bridged = 0b001;
  record.erase(record.begin() + 5000);
  const Placed out = place(record);
  EXPECT_EQ(out.placed[4000].accel_mps2[1], out.taken[4000].accel_mps2[1]);
  EXPECT_NE(out.placed[4000].accel_mps2[0], out.taken[4000].accel_mps2[0]);
  EXPECT_EQ(out.placed[4100].accel_mps2[0], out.taken[4100].accel_mps2[0]);
  EXPECT_NE(out.placed[4100].accel_mps2[1], out.taken[4100].accel_mps2[1]);
  for (std::size_t i = 4980; i < 5020; ++i) {
    const bool stays = i >= 4988 && i < 5012;
    EXPECT_EQ(out.placed[i].accel_mps2 == out.taken[i].accel_mps2, stays) << i;
  }
}

}  // namespace
}  // namespace dampline
