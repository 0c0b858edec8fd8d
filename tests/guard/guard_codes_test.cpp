// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "dampline/guard/guard.hpp"
#include "sim_hw/noise.hpp"

namespace dampline {
namespace {

constexpr double kStepMps2 = 0.005;

GuardConfig coded(double rate_hz = 300.0) {
  GuardConfig config;
  config.sample_rate_hz = rate_hz;
  config.step_mps2.fill(kStepMps2);
  return config;
}

/// Three channels of normal codes, too weak for the guards that need motion.
class Codes {
 public:
  explicit Codes(const GuardConfig& config = coded())
      : guard_{std::make_unique<Guard>(config)}, rate_hz_{config.sample_rate_hz} {}

  using Change = std::function<void(Sample&)>;
  void run(
      std::int64_t samples, const Change& change = [](Sample&) {}) {
    for (std::int64_t i = 0; i < samples; ++i) {
      Sample sample;
      sample.tick = tick_++;
      sample.time_ns = std::llround(1e9 * static_cast<double>(sample.tick) / rate_hz_);
      for (double& accel : sample.accel_mps2) accel = code(std::llround(40.0 * random_.normal()));
      change(sample);
      guard_->update(sample);
    }
  }
  static double code(std::int64_t number) { return kStepMps2 * static_cast<double>(number); }
  void skip(std::int64_t ticks) { tick_ += ticks; }
  Guard& guard() { return *guard_; }
  [[nodiscard]] std::int64_t tick() const { return tick_; }
  [[nodiscard]] std::span<const Fault> faults() const { return guard_->faults(); }
  [[nodiscard]] const Fault* find(FaultKind kind) const {
    for (const Fault& fault : faults())
      if (fault.kind == kind) return &fault;
    return nullptr;
  }
  [[nodiscard]] bool spoils(FaultKind kind, std::int64_t tick) const {
    return (guard_->spoilt(tick, tick) >> static_cast<unsigned>(kind) & 1U) != 0;
  }

 private:
  std::unique_ptr<Guard> guard_;
  double rate_hz_;
  std::int64_t tick_{0};
  sim::Random random_{12, sim::Stream::kSensors};
};

TEST(GuardConfig, HasItsLimits) {
  const auto ok = [](const std::function<void(GuardConfig&)>& change) {
    GuardConfig config;
    change(config);
    return Guard::check(config).ok();
  };
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double rate_hz : {50.0, 300.0, 2000.0})
    EXPECT_TRUE(ok([&](GuardConfig& c) { c.sample_rate_hz = rate_hz; })) << rate_hz;
  for (const double rate_hz : {49.9, 2000.1, std::nan("")})
    EXPECT_FALSE(ok([&](GuardConfig& c) { c.sample_rate_hz = rate_hz; })) << rate_hz;
  for (const auto& [value, fine] :
       {std::pair{0.0, true}, std::pair{0.1, true}, std::pair{-0.1, false},
        std::pair{infinite, false}, std::pair{std::nan(""), false}}) {
    for (std::size_t c = 0; c < kChannels; ++c) {
      EXPECT_EQ(ok([&, v = value](GuardConfig& g) { g.step_mps2[c] = v; }), fine);
      EXPECT_EQ(ok([&, v = value](GuardConfig& g) { g.noise_mps2[c] = v; }), fine);
    }
    EXPECT_EQ(ok([&, v = value](GuardConfig& g) { g.wheelbase_m = v; }), fine);
    EXPECT_EQ(ok([&, v = value](GuardConfig& g) { g.speed_mps = v; }), fine);
    EXPECT_EQ(ok([&, v = value](GuardConfig& g) { g.anti_alias.corner_hz = v; }), fine);
  }
  EXPECT_TRUE(ok([](GuardConfig& g) { g.anti_alias.order = 1; }));
  EXPECT_FALSE(ok([](GuardConfig& g) { g.anti_alias.order = 0; }));
}

TEST(GuardCodes, OfNormalCodesNothingIsWrong) {
  Codes codes;
  codes.run(60 * 300);
  codes.guard().finish();
  EXPECT_TRUE(codes.faults().empty());
  EXPECT_EQ(codes.guard().inputs().impacts, (std::array<std::uint64_t, 3>{}));
  WrongSample wrong;
  EXPECT_FALSE(codes.guard().next_wrong_sample(wrong));
}

TEST(GuardCodes, ThreeSamplesAtFullScaleAreClipping) {
  Codes codes;
  codes.run(1000);
  const auto full = [](Sample& sample) {
    sample.saturated = 0b010;
    sample.accel_mps2[1] = -3.0;
  };
  codes.run(1, full);
  codes.run(700);
  codes.run(1, full);
  EXPECT_TRUE(codes.faults().empty());
  EXPECT_TRUE(codes.spoils(FaultKind::kClipping, 1000)) << "known at once";
  EXPECT_FALSE(codes.spoils(FaultKind::kClipping, 600));
  codes.run(500);
  codes.run(1, full);
  ASSERT_EQ(codes.faults().size(), 1U);
  EXPECT_EQ(codes.faults()[0].kind, FaultKind::kClipping);
  EXPECT_EQ(codes.faults()[0].channel, FaultChannel::kWheelset1);
  EXPECT_EQ(codes.faults()[0].time_s, 1000 / 300.0) << "of the first";
  EXPECT_EQ(codes.faults()[0].count, 3U);
  EXPECT_EQ(codes.faults()[0].size, 3.0);
  const double last_s = static_cast<double>(codes.tick()) / 300.0;
  codes.run(1, full);
  EXPECT_EQ(codes.faults()[0].count, 4U);
  EXPECT_EQ(codes.faults()[0].last_s, last_s);
}

TEST(GuardCodes, CountsSamplesThatTicksMiss) {
  for (const std::int64_t missing : {1, 8, 9, 5000}) {
    Codes codes;
    codes.run(1000);
    codes.skip(missing);
    codes.run(1000);
    ASSERT_EQ(codes.faults().size(), 1U) << missing;
    const Fault& fault = codes.faults()[0];
    EXPECT_EQ(fault.kind, FaultKind::kLostSamples);
    EXPECT_EQ(fault.channel, FaultChannel::kAll);
    EXPECT_EQ(fault.size, static_cast<double>(missing));
    EXPECT_EQ(fault.count, 1U);
    EXPECT_EQ(fault.time_s, 1000 / 300.0);
    EXPECT_NE(codes.guard().spoilt(1000, 1000) & FaultLog::kGapBit, 0U);
    EXPECT_EQ(codes.guard().spoilt(0, 800), 0U);
  }
}

TEST(GuardCodes, CountsSamplesThatCameIncomplete) {
  Codes codes;
  codes.run(100);
  codes.run(2, [](Sample& sample) { sample.lost = true; });
  codes.run(100);
  ASSERT_EQ(codes.faults().size(), 1U);
  EXPECT_EQ(codes.faults()[0].size, 2.0);
  EXPECT_EQ(codes.faults()[0].count, 2U);
  EXPECT_EQ(codes.faults()[0].time_s, 100 / 300.0);
}

// What is no number is the screen's: those samples came.
TEST(GuardCodes, SamplesThatAreNoNumberAreNotLost) {
  const auto none = [](Sample& sample) { sample.accel_mps2[2] = std::nan(""); };
  Codes codes;
  codes.run(1000);
  codes.run(3, none);
  codes.run(1000);
  EXPECT_TRUE(codes.faults().empty());
  codes.run(2, none);
  codes.skip(3);
  codes.run(1000);
  ASSERT_EQ(codes.faults().size(), 1U);
  EXPECT_EQ(codes.faults()[0].size, 3.0);
  codes.skip(2);
  codes.run(10);
  EXPECT_EQ(codes.faults()[0].size, 5.0) << "counted for their own gap alone";
}

TEST(GuardCodes, IgnoresSamplesWhoseTicksDoNotRise) {
  Codes codes;
  codes.run(1000);
  codes.skip(-50);
  codes.run(50, [](Sample& sample) { sample.saturated = 7; });
  codes.run(100);
  EXPECT_TRUE(codes.faults().empty());
}

/// Holds a channel at one code, the next one moves to and fro by so many, the other one a little.
Codes::Change held(std::size_t channel, std::int64_t next_moves = 1000) {
  return [=](Sample& sample) {
    std::array<std::int64_t, kChannels> codes{};
    codes[channel] = 17;
    codes[(channel + 1) % kChannels] = sample.tick % 2 * next_moves;
    codes[(channel + 2) % kChannels] = next_moves > 100 && sample.tick % 3 == 0 ? 9 : 0;
    for (std::size_t c = 0; c < kChannels; ++c) sample.accel_mps2[c] = Codes::code(codes[c]);
  };
}

TEST(GuardCodes, AChannelIsStuckFromEightySamplesOn) {
  for (std::size_t c = 0; c < kChannels; ++c) {
    Codes codes;
    codes.run(1000);
    codes.run(79, held(c));
    codes.run(700);
    EXPECT_EQ(codes.find(FaultKind::kStuckChannel), nullptr);
    const std::int64_t first = codes.tick();
    codes.run(79, held(c));
    EXPECT_EQ(codes.find(FaultKind::kStuckChannel), nullptr);
    codes.run(1, held(c));
    const Fault* fault = codes.find(FaultKind::kStuckChannel);
    ASSERT_NE(fault, nullptr);
    EXPECT_EQ(fault->channel, channel_of(c));
    EXPECT_EQ(fault->time_s, static_cast<double>(first) / 300.0);
    EXPECT_EQ(fault->size, 80 / 300.0);
    EXPECT_TRUE(codes.spoils(FaultKind::kStuckChannel, first)) << "back to the first";
    codes.run(520, held(c));
    EXPECT_TRUE(codes.spoils(FaultKind::kStuckChannel, codes.tick() - 1));
    codes.run(1);
    EXPECT_EQ(fault->size, 2.0) << "of all it was";
    EXPECT_EQ(fault->count, 1U);
  }
}

TEST(GuardCodes, AFasterChannelIsStuckAfterAFifthOfASecond) {
  Codes codes{coded(1000.0)};
  codes.run(1000);
  codes.run(199, held(0));
  EXPECT_EQ(codes.find(FaultKind::kStuckChannel), nullptr);
  codes.run(1, held(0));
  EXPECT_NE(codes.find(FaultKind::kStuckChannel), nullptr);
}

TEST(GuardCodes, AChannelIsStuckWhereTheOthersSpanMoreThanEightCodes) {
  for (const auto& [span, stuck] : {std::pair{8, false}, std::pair{9, true}}) {
    Codes codes;
    codes.run(1000);
    codes.run(300, held(0, span));
    const Fault* const fault = codes.find(FaultKind::kStuckChannel);
    EXPECT_EQ(fault != nullptr && fault->channel == FaultChannel::kFrame, stuck) << span;
  }
}

/// A channel that leaps to a code and holds it for some samples.
void leap(Codes& codes, std::int64_t code, int samples, std::int64_t others = 100) {
  codes.run(samples, [&](Sample& sample) {
    sample.accel_mps2[1] = Codes::code(code);
    sample.accel_mps2[0] = Codes::code(sample.tick % 2 * others);
    sample.accel_mps2[2] = 0.0;
  });
}

/// What three leaps make; ends of the range lie farther out.
const Fault* contact_of(Codes& codes, const std::vector<std::int64_t>& leaps, int samples,
                        std::int64_t others = 100) {
  codes.run(3000, [](Sample& sample) {
    if (sample.tick == 500) sample.accel_mps2[1] = Codes::code(3000);
    if (sample.tick == 900) sample.accel_mps2[1] = Codes::code(-3000);
  });
  codes.run(20, [](Sample& sample) {
    if (sample.tick % 3000 == 5) sample.accel_mps2[1] = Codes::code(3000);
    if (sample.tick % 3000 == 15) sample.accel_mps2[1] = Codes::code(-3000);
  });
  for (const std::int64_t code : leaps) {
    codes.run(100);
    codes.run(1, [](Sample& sample) { sample.accel_mps2[1] = 0.0; });
    leap(codes, code, samples, others);
    codes.run(1, [](Sample& sample) { sample.accel_mps2[1] = 0.0; });
  }
  codes.run(20);
  return codes.find(FaultKind::kStuckChannel);
}

TEST(GuardCodes, ThreeLeapsToOneCodeAreALooseContact) {
  Codes codes;
  const Fault* const fault = contact_of(codes, {1500, 1500, 1500}, 5);
  ASSERT_NE(fault, nullptr);
  EXPECT_EQ(fault->channel, FaultChannel::kWheelset1);
  EXPECT_NEAR(fault->size, 5 / 300.0, 1e-12);
  EXPECT_EQ(fault->count, 1U);
  EXPECT_TRUE(codes.spoils(FaultKind::kStuckChannel, codes.tick() - 100));
  Codes two;
  EXPECT_EQ(contact_of(two, {1500, 1500}, 5), nullptr);
  Codes different;
  EXPECT_EQ(contact_of(different, {1500, 1600, 1500, 1600, 1500}, 5), nullptr);
  Codes brief;
  EXPECT_EQ(contact_of(brief, {1500, 1500, 1500}, 3), nullptr) << "three samples are motion";
  Codes four;
  EXPECT_NE(contact_of(four, {1500, 1500, 1500}, 4), nullptr);
  Codes end;
  EXPECT_EQ(contact_of(end, {3000, 3000, 3000}, 5), nullptr) << "the end of its range";
  Codes still;
  EXPECT_EQ(contact_of(still, {1500, 1500, 1500}, 5, 8), nullptr) << "nothing moves";
  Codes moved;
  EXPECT_NE(contact_of(moved, {1500, 1500, 1500}, 5, 9), nullptr);
}

// Second differences of these codes deviate by sqrt(6) 40 = 98: three of that, or 0.3 of it where
// the code is held for six samples.
TEST(GuardCodes, AContactLeapsByThreeDeviations) {
  for (const auto& [code, samples, named] : {std::tuple{260, 5, false}, std::tuple{330, 5, true},
                                             std::tuple{25, 6, false}, std::tuple{35, 6, true}}) {
    Codes codes;
    EXPECT_EQ(contact_of(codes, {code, code, code}, samples) != nullptr, named) << code;
  }
}

TEST(GuardCodes, AChannelIsACopyByNineTenthsOfItsCodes) {
  for (const auto& [every, copied] : {std::pair{8, false}, std::pair{13, true}}) {
    for (std::size_t c = 0; c < kChannels; ++c) {
      Codes codes;
      codes.run(6100, [&, e = every](Sample& sample) {
        if (sample.tick % e != 0) sample.accel_mps2[(c + 1) % 3] = sample.accel_mps2[c];
      });
      const Fault* const fault = codes.find(FaultKind::kIdenticalChannels);
      ASSERT_EQ(fault != nullptr, copied) << every;
      if (!copied) continue;
      EXPECT_EQ(fault->channel, c == 1 ? FaultChannel::kWheelsets : FaultChannel::kAll);
      EXPECT_EQ(fault->count, 2U) << "a block each";
      EXPECT_EQ(fault->time_s, 0.0);
    }
  }
}

TEST(GuardCodes, CopiesThatHardlyMoveTellNothing) {
  for (const auto& [moves, copied] : {std::pair{280, false}, std::pair{320, true}}) {
    Codes codes;
    codes.run(3001, [&, m = moves](Sample& sample) {
      const auto code = std::min<std::int64_t>(sample.tick, m) % 7;
      sample.accel_mps2[1] = sample.accel_mps2[2] = Codes::code(code);
      sample.accel_mps2[0] = 0.0;
    });
    EXPECT_EQ(codes.find(FaultKind::kIdenticalChannels) != nullptr, copied) << moves;
  }
}

Codes::Change raised(std::array<double, 3> by_mps2) {
  return [=](Sample& sample) {
    for (std::size_t c = 0; c < kChannels; ++c) sample.accel_mps2[c] += by_mps2[c];
  };
}

TEST(GuardCodes, NamesTheChannelWhoseZeroJumped) {
  for (std::size_t c = 0; c < kChannels; ++c) {
    Codes codes;
    codes.run(9000);
    std::array<double, 3> jump{};
    jump[c] = -0.8;
    codes.run(9000, raised(jump));
    ASSERT_EQ(codes.faults().size(), 1U);
    const Fault& fault = codes.faults()[0];
    EXPECT_EQ(fault.kind, FaultKind::kDcJump);
    EXPECT_EQ(fault.channel, channel_of(c));
    EXPECT_NEAR(fault.size, -0.8, 0.03);
    EXPECT_NEAR(fault.time_s, 30.0, 0.7);
    EXPECT_TRUE(codes.spoils(FaultKind::kDcJump, 9000));
    EXPECT_FALSE(codes.spoils(FaultKind::kDcJump, 9000 - 900));
    EXPECT_FALSE(codes.spoils(FaultKind::kDcJump, 9000 + 900));
  }
}

// A quarter of the largest, or 0.1 m/s^2: so much the jumps of all channels differ in a curve.
TEST(GuardCodes, TakesAJumpOfAllChannelsAlikeForTheTrack) {
  const auto faults_after = [](std::array<double, 3> jump) {
    Codes codes;
    codes.run(9000);
    codes.run(9000, raised(jump));
    return codes.faults().size();
  };
  EXPECT_EQ(faults_after({2.0, 1.6, 2.0}), 0U);
  EXPECT_EQ(faults_after({2.0, 1.4, 2.0}), 3U);
  EXPECT_EQ(faults_after({-2.0, -1.6, -2.0}), 0U);
  EXPECT_EQ(faults_after({0.35, 0.35, 0.28}), 0U);
  EXPECT_EQ(faults_after({0.45, 0.45, 0.29}), 3U);
  EXPECT_EQ(faults_after({2.0, 2.0, 0.0}), 2U);
  EXPECT_EQ(faults_after({2.0, 2.0, -2.0}), 3U);
}

TEST(GuardCodes, TellsAJumpAtTheEndOfTheRecordToo) {
  Codes codes;
  codes.run(9000);
  codes.run(12 * 300, raised({0.8, 0.0, 0.0}));
  EXPECT_TRUE(codes.faults().empty()) << "the others may have it too";
  codes.guard().finish();
  EXPECT_EQ(codes.faults().size(), 1U);
}

// Eight samples are bridged; after more, what was is forgotten.
TEST(GuardCodes, AJumpAcrossAPauseIsNone) {
  for (const auto& [missing, named] : {std::pair{8, true}, std::pair{9, false}}) {
    Codes codes;
    codes.run(9000);
    codes.skip(missing);
    codes.run(9000, raised({0.8, 0.0, 0.0}));
    EXPECT_EQ(codes.find(FaultKind::kDcJump) != nullptr, named) << missing;
  }
}

// Stamps that run by another rate than the declared one, for three blocks of ten seconds.
TEST(GuardCodes, NamesARateThatTheStampsContradict) {
  for (const auto& [rate_hz, seconds, named] :
       {std::tuple{300.85, 60, false}, std::tuple{300.95, 60, true}, std::tuple{299.05, 60, true},
        std::tuple{303.0, 29, false}, std::tuple{303.0, 31, true}}) {
    Codes codes;
    codes.run(seconds * 300, [r = rate_hz](Sample& sample) {
      sample.time_ns = std::llround(1e9 * static_cast<double>(sample.tick) / r);
    });
    const Fault* const fault = codes.find(FaultKind::kWrongSampleRate);
    ASSERT_EQ(fault != nullptr, named) << rate_hz;
    if (!named) continue;
    EXPECT_NEAR(fault->size, rate_hz, 0.01);
    EXPECT_EQ(fault->channel, FaultChannel::kAll);
    EXPECT_EQ(fault->time_s, 20.0);
  }
  Codes none;
  none.run(9000, [](Sample& sample) { sample.time_ns = 0; });
  EXPECT_TRUE(none.faults().empty()) << "no stamps";
}

Codes::Change spikes(std::size_t channel, const std::vector<std::int64_t>& ticks) {
  return [=](Sample& sample) {
    for (const std::int64_t tick : ticks)
      if (sample.tick == tick) sample.accel_mps2[channel] += Codes::code(2000);
  };
}

TEST(GuardCodes, ThreeWrongSamplesAreSpikes) {
  Codes two;
  two.run(12'000, spikes(2, {1000, 2310}));
  EXPECT_TRUE(two.faults().empty());
  EXPECT_TRUE(two.spoils(FaultKind::kSpikes, 1000)) << "all the same";
  Codes three;
  three.run(12'000, spikes(2, {1000, 2310, 7020}));
  ASSERT_EQ(three.faults().size(), 1U);
  const Fault& fault = three.faults()[0];
  EXPECT_EQ(fault.kind, FaultKind::kSpikes);
  EXPECT_EQ(fault.channel, FaultChannel::kWheelset2);
  EXPECT_EQ(fault.count, 3U);
  EXPECT_NEAR(fault.size, 2000 * kStepMps2, 1.0);
  EXPECT_NEAR(fault.time_s, 1000 / 300.0, 1e-9);
  EXPECT_NEAR(fault.last_s, 7020 / 300.0, 1e-9);
  WrongSample wrong;
  for (const std::int64_t tick : {1000, 2310, 7020}) {
    ASSERT_TRUE(three.guard().next_wrong_sample(wrong));
    EXPECT_EQ(wrong.tick, tick);
    EXPECT_EQ(wrong.channel, 2U);
  }
  EXPECT_FALSE(three.guard().next_wrong_sample(wrong));
}

TEST(GuardCodes, KeepsTheNewestSixteenWrongSamples) {
  std::vector<std::int64_t> ticks;
  std::int64_t at = 900;
  for (std::int64_t i = 0; i < 20; ++i) ticks.push_back(at += 650 + 250 * (i * 7 % 5));
  Codes codes;
  codes.run(ticks.back() + 1500, spikes(0, ticks));
  std::vector<std::int64_t> found;
  for (WrongSample wrong; codes.guard().next_wrong_sample(wrong);) found.push_back(wrong.tick);
  ASSERT_EQ(found.size(), 16U);
  EXPECT_EQ(found.front(), ticks[4]);
  EXPECT_EQ(found.back(), ticks[19]);
}

TEST(GuardCodes, SpikesInARhythmAreImpacts) {
  std::vector<std::int64_t> ticks;
  for (std::int64_t i = 0; i < 40; ++i) ticks.push_back(900 + 150 * i);
  Codes codes;
  codes.run(12'000, spikes(1, ticks));
  EXPECT_EQ(codes.find(FaultKind::kSpikes), nullptr);
  EXPECT_EQ(codes.guard().inputs().impacts[1], 40U);
}

/// Blows that ring for some samples.
Codes::Change blows(std::size_t channel, std::int64_t every) {
  return [=](Sample& sample) {
    const double since = static_cast<double>(sample.tick % every - 90);
    if (since >= 0.0 && since < 15.0)
      sample.accel_mps2[channel] +=
          Codes::code(2000) * std::exp(-0.2 * since) * std::cos(1.5 * since);
  };
}

TEST(GuardCodes, CountsImpactsOfEachChannel) {
  Codes codes;
  codes.run(12'300, blows(0, 601));
  EXPECT_TRUE(codes.faults().empty());
  EXPECT_EQ(codes.guard().inputs().impacts[1], 0U);
  EXPECT_NEAR(static_cast<double>(codes.guard().inputs().impacts[0]), 20.0, 1.0);
}

TEST(GuardCodes, ABitThatDoesNotMoveIsALossWhereTheStepIsDeclared) {
  const auto coarse = [](Sample& sample) {
    for (double& accel : sample.accel_mps2)
      accel = 4.0 * kStepMps2 * std::round(accel / (4.0 * kStepMps2));
  };
  Codes codes;
  codes.run(3001, coarse);
  ASSERT_EQ(codes.faults().size(), 3U);
  for (std::size_t c = 0; c < kChannels; ++c) {
    EXPECT_EQ(codes.faults()[c].kind, FaultKind::kResolutionLoss);
    EXPECT_EQ(codes.faults()[c].channel, channel_of(c));
    EXPECT_NEAR(codes.faults()[c].size, 4.0 * kStepMps2, 1e-12);
    EXPECT_EQ(codes.faults()[c].time_s, 0.0);
  }
  EXPECT_TRUE(codes.spoils(FaultKind::kResolutionLoss, 10));
  EXPECT_TRUE(codes.spoils(FaultKind::kResolutionLoss, 3000));
  EXPECT_FALSE(codes.spoils(FaultKind::kResolutionLoss, 3300));
  Codes undeclared{GuardConfig{}};
  undeclared.run(9000, coarse);
  EXPECT_TRUE(undeclared.faults().empty()) << "its step is what it shows";
}

TEST(GuardCodes, NamesTheLevelAtWhichAChannelClips) {
  Codes codes;
  codes.run(6001, [](Sample& sample) {
    sample.accel_mps2[0] = std::max(sample.accel_mps2[0], Codes::code(-70));
  });
  const Fault* const fault = codes.find(FaultKind::kClipping);
  ASSERT_NE(fault, nullptr);
  EXPECT_EQ(fault->channel, FaultChannel::kFrame);
  EXPECT_NEAR(fault->size, 70 * kStepMps2, 1e-12);
  EXPECT_NEAR(static_cast<double>(fault->count), 6000 * 0.0408, 40.0) << "samples there";
  EXPECT_LT(fault->time_s, 1.0);
  EXPECT_TRUE(codes.spoils(FaultKind::kClipping, 5900));
}

// What nobody declared is learnt in ten seconds, and what was counted before is forgotten.
TEST(GuardCodes, LearnsItsStepAndCountsByIt) {
  Codes codes{GuardConfig{}};
  const auto clip = [](Sample& sample) {
    sample.accel_mps2[1] = std::min(sample.accel_mps2[1], Codes::code(70));
  };
  codes.run(3001, clip);
  EXPECT_TRUE(codes.faults().empty());
  codes.run(6000, clip);
  const Fault* const fault = codes.find(FaultKind::kClipping);
  ASSERT_NE(fault, nullptr);
  EXPECT_EQ(fault->channel, FaultChannel::kWheelset1);
  EXPECT_NEAR(fault->size, 70 * kStepMps2, 1e-9);
  EXPECT_GT(fault->time_s, 10.0);
  EXPECT_EQ(codes.faults().size(), 1U);
  codes.run(6000, spikes(0, {9300, 10'100, 11'800, 12'999}));
  const Fault* const spiked = codes.find(FaultKind::kSpikes);
  ASSERT_NE(spiked, nullptr);
  EXPECT_NEAR(spiked->size, 2000 * kStepMps2, 1.0);
}

TEST(GuardCodes, RepeatedSamplesAreTheirExcess) {
  std::array<double, 3> last{};
  Codes codes;
  codes.run(3001, [&](Sample& sample) {
    if (sample.tick > 500 && sample.tick % 100 == 0 && sample.tick < 1700) sample.accel_mps2 = last;
    last = sample.accel_mps2;
  });
  const Fault* const fault = codes.find(FaultKind::kRepeatedSamples);
  ASSERT_NE(fault, nullptr);
  EXPECT_EQ(fault->channel, FaultChannel::kAll);
  EXPECT_EQ(fault->size, 9.0);
  EXPECT_EQ(fault->time_s, 600 / 300.0) << "the first of them";
}

TEST(GuardCodes, JudgesTheRestOfTheRecord) {
  Codes codes;
  const auto coarse = [](Sample& sample) {
    sample.accel_mps2[1] = 2.0 * kStepMps2 * std::round(sample.accel_mps2[1] / (2.0 * kStepMps2));
  };
  codes.run(2000, coarse);
  EXPECT_TRUE(codes.faults().empty());
  codes.guard().finish();
  EXPECT_EQ(codes.faults().size(), 1U);
}

}  // namespace
}  // namespace dampline
