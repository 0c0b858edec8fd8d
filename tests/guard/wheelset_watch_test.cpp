// SPDX-License-Identifier: MIT
#include "dampline/guard/wheelset_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "sim_hw/noise.hpp"

namespace dampline {
namespace {

constexpr int kDelay = 24;  // samples of wheelset 2

/// Two wheelsets on a track of white noise, the second kDelay samples later; samples may be lost
/// or repeated in both at once.
class TwoWheelsets {
 public:
  double noise{0.02};
  std::function<double(double)> sensor1 = [](double x) { return x; };
  std::function<double(double)> sensor2 = [](double x) { return x; };
  int late2{0};  ///< samples by which wheelset 2 comes later than it should

  explicit TwoWheelsets(double delay_samples = kDelay) : delay_s_{delay_samples / 300.0} {
    track_.resize(200'000);
    for (double& x : track_) x = random_.normal();
  }
  void run(int samples) {
    for (int i = 0; i < samples; ++i, ++tick_, ++place_) {
      const auto at = [&](std::int64_t n) { return track_[static_cast<std::size_t>(1000 + n)]; };
      watch_.update(tick_, sensor1(at(place_)),
                    sensor2(at(place_ - kDelay - late2)) + noise * random_.normal(), *log_);
      if (tick_ % 3000 == 2999) {
        watch_.close_block(sound_, tick_, *log_);
        watch_.set_delay(delay_s_);
      }
    }
  }
  void lose(int samples) { place_ += samples; }
  WheelsetWatch& watch() { return watch_; }
  [[nodiscard]] std::int64_t tick() const { return tick_; }
  [[nodiscard]] const FaultLog& log() const { return *log_; }
  void set_sound(bool sound) { sound_ = sound; }

 private:
  sim::Random random_{3, sim::Stream::kTrack};
  std::vector<double> track_;
  std::unique_ptr<FaultLog> log_{std::make_unique<FaultLog>(300.0)};
  WheelsetWatch watch_{300.0};
  double delay_s_;
  std::int64_t tick_{0};
  std::int64_t place_{0};
  bool sound_{true};
};

TEST(WheelsetWatch, NamesSamplesLostOrRepeatedInBoth) {
  for (const double noise : {0.02, 0.3}) {  // by what is left of the difference, or by its sums
    for (const int lost : {-3, -1, 1, 2, 3}) {
      TwoWheelsets wheelsets;
      wheelsets.noise = noise;
      wheelsets.run(9000);
      const std::int64_t tick = wheelsets.tick();
      wheelsets.lose(lost);
      wheelsets.run(3480);
      EXPECT_TRUE(wheelsets.log().faults().empty()) << "impacts may still become known";
      wheelsets.run(600);
      ASSERT_EQ(wheelsets.log().faults().size(), 1U) << lost << " in " << noise;
      const Fault& fault = wheelsets.log().faults()[0];
      EXPECT_EQ(fault.kind, lost > 0 ? FaultKind::kLostSamples : FaultKind::kRepeatedSamples);
      EXPECT_EQ(fault.channel, FaultChannel::kAll);
      EXPECT_EQ(fault.size, std::abs(lost));
      EXPECT_EQ(fault.count, 1U);
      EXPECT_NEAR(fault.time_s * 300.0, static_cast<double>(tick), 4.0);
      EXPECT_TRUE(wheelsets.log().spoilt(fault.kind, FaultChannel::kAll, tick + kDelay / 2));
      EXPECT_TRUE(wheelsets.log().spoilt(fault.kind, FaultChannel::kAll, tick - 1));
      EXPECT_FALSE(wheelsets.log().spoilt(fault.kind, FaultChannel::kAll, tick - 600));
      EXPECT_FALSE(wheelsets.log().spoilt(fault.kind, FaultChannel::kAll, tick + 600));
    }
  }
}

// Chunks of eight samples tell where: on the mean of the eight places in them to a sample.
TEST(WheelsetWatch, TellsThePlaceOfASlipWithoutBias) {
  double sum = 0.0;
  for (int place = 0; place < 8; ++place) {
    TwoWheelsets wheelsets;
    wheelsets.run(9000 + place);
    wheelsets.lose(1);
    wheelsets.run(4500);
    const Fault* const fault = wheelsets.log().find(FaultKind::kLostSamples, FaultChannel::kAll);
    ASSERT_NE(fault, nullptr) << place;
    sum += fault->time_s * 300.0 - (9000.0 + place);
  }
  EXPECT_NEAR(sum / 8.0, 0.0, 1.0);
}

// Sixteen samples before it, and the delay after it. It is seen three samples late.
TEST(WheelsetWatch, SpoilsWhatLiesRoundASlip) {
  const auto spoils = [](int before, std::int64_t tick) {
    TwoWheelsets wheelsets;
    wheelsets.run(before);
    wheelsets.lose(1);
    wheelsets.run(4500);
    return wheelsets.log().spoilt(FaultKind::kLostSamples, FaultChannel::kAll, tick);
  };
  EXPECT_TRUE(spoils(9010, 8999));
  EXPECT_FALSE(spoils(9019, 8999));
  EXPECT_FALSE(spoils(9270, 9300));
  EXPECT_TRUE(spoils(9285, 9300));
}

TEST(WheelsetWatch, FourSamplesAreTooManyToTell) {
  TwoWheelsets wheelsets;
  wheelsets.run(9000);
  wheelsets.lose(4);
  wheelsets.run(6000);
  EXPECT_TRUE(wheelsets.log().faults().empty());
}

// 40 samples and the delay to either side, before or after it is known.
TEST(WheelsetWatch, TakesAnImpactForNoLostSample) {
  // The slip is seen three samples late.
  for (const auto& [off, named] :
       {std::pair{-100, true}, std::pair{3 - 64, true}, std::pair{3 - 63, false},
        std::pair{3 + 63, false}, std::pair{3 + 64, true}, std::pair{100, true}}) {
    for (const bool early : {false, true}) {
      TwoWheelsets wheelsets;
      wheelsets.run(9000);
      if (early) wheelsets.watch().strike(wheelsets.tick() + off);
      const std::int64_t tick = wheelsets.tick();
      wheelsets.lose(1);
      wheelsets.run(1000);
      if (!early) wheelsets.watch().strike(tick + off);
      wheelsets.run(4000);
      EXPECT_EQ(wheelsets.log().faults().empty(), !named) << off;
    }
  }
}

TEST(WheelsetWatch, ForgetsASlipWhereTheDelayIsInDoubt) {
  TwoWheelsets wheelsets;
  wheelsets.run(9000);
  wheelsets.lose(1);
  wheelsets.run(1000);
  wheelsets.watch().doubt();
  wheelsets.run(5000);
  EXPECT_TRUE(wheelsets.log().faults().empty());
}

TEST(WheelsetWatch, FiveSlipsAreRatherWheelFlats) {
  for (const auto& [slips, count] : {std::pair{4, 4U}, std::pair{5, 0U}}) {
    TwoWheelsets wheelsets;
    wheelsets.run(9000);
    for (int i = 0; i < slips; ++i) {
      wheelsets.lose(1);
      wheelsets.run(300);
    }
    wheelsets.run(5000);
    const Fault* const fault = wheelsets.log().find(FaultKind::kLostSamples, FaultChannel::kAll);
    EXPECT_EQ(fault == nullptr ? 0U : fault->count, count);
  }
}

TEST(WheelsetWatch, NeedsADelayAndABeginning) {
  for (const double noise : {0.02, 0.3}) {
    TwoWheelsets wheelsets;
    wheelsets.noise = noise;
    wheelsets.run(2900);  // no delay so far
    wheelsets.lose(1);
    wheelsets.run(300);
    wheelsets.lose(1);
    wheelsets.run(1500);
    wheelsets.lose(1);
    wheelsets.run(6000);
    EXPECT_TRUE(wheelsets.log().faults().empty()) << "2400 samples with the delay";
  }
}

TEST(WheelsetWatch, KnowsNoDelayAfterARestart) {
  for (const bool restarts : {false, true}) {
    TwoWheelsets wheelsets;
    wheelsets.run(9010);
    if (restarts) wheelsets.watch().restart();
    wheelsets.run(1000);
    wheelsets.lose(1);
    wheelsets.run(6000);
    EXPECT_EQ(wheelsets.log().faults().empty(), restarts);
  }
}

// What stands before a pause does not continue behind it.
TEST(WheelsetWatch, APauseIsNoSlip) {
  for (const double noise : {0.02, 0.3}) {
    TwoWheelsets wheelsets;
    wheelsets.noise = noise;
    wheelsets.run(9010);
    for (int pause = 0; pause < 3; ++pause) {
      wheelsets.watch().restart();
      wheelsets.watch().set_delay(kDelay / 300.0);
      wheelsets.lose(1);
      wheelsets.run(5000);
    }
    EXPECT_TRUE(wheelsets.log().faults().empty());
  }
}

TEST(WheelsetWatch, KeepsTheDifferenceWhileThereIsNoOther) {
  TwoWheelsets wheelsets;
  wheelsets.run(60'000);
  const double difference_mps2 = wheelsets.watch().difference_mps2();
  wheelsets.watch().restart();
  FaultLog log{300.0};
  for (int block = 0; block < 10; ++block) wheelsets.watch().close_block(true, 60'000, log);
  EXPECT_EQ(wheelsets.watch().difference_mps2(), difference_mps2);
}

TEST(WheelsetWatch, KnowsWhenTheDelayIsAnother) {
  TwoWheelsets wheelsets;
  wheelsets.run(3000);
  EXPECT_FALSE(wheelsets.watch().differs_from((kDelay + 0.07) / 300.0));
  EXPECT_TRUE(wheelsets.watch().differs_from((kDelay + 0.09) / 300.0));
  EXPECT_TRUE(wheelsets.watch().differs_from((kDelay - 0.09) / 300.0));
}

// What stays apart for longer than a slip moved at once.
TEST(WheelsetWatch, SeesWhereOneWheelsetMovesByWholeSamplesForGood) {
  for (const auto& [late, jumps] : {std::pair{1, false}, std::pair{2, true}, std::pair{-3, true}}) {
    TwoWheelsets wheelsets;
    wheelsets.run(30'000);
    EXPECT_EQ(wheelsets.watch().jump_tick(), -1);
    wheelsets.late2 = late;
    const std::int64_t tick = wheelsets.tick();
    wheelsets.run(2000);
    if (jumps) {
      EXPECT_NEAR(static_cast<double>(wheelsets.watch().jump_tick() - tick), 35.0, 4.0);
    } else {
      EXPECT_EQ(wheelsets.watch().jump_tick(), -1);
    }
    EXPECT_TRUE(wheelsets.log().faults().empty());
  }
}

// A slip of two samples that ended a second before is not where one sample went for good.
TEST(WheelsetWatch, ASlipThatEndedIsNoJump) {
  TwoWheelsets wheelsets;
  wheelsets.run(30'000);
  wheelsets.lose(2);
  wheelsets.run(330);
  wheelsets.late2 = 1;
  wheelsets.run(2000);
  EXPECT_EQ(wheelsets.watch().jump_tick(), -1);
}

// Of normal noise half of the chunks of eight differ by less than 0.957 of its deviation.
TEST(WheelsetWatch, MeasuresTheDifferenceOfTheWheelsets) {
  for (const double noise : {0.02, 0.5}) {
    TwoWheelsets wheelsets;
    wheelsets.noise = noise;
    EXPECT_EQ(wheelsets.watch().difference_mps2(), 0.0);
    wheelsets.run(60'000);
    EXPECT_NEAR(wheelsets.watch().difference_mps2() / noise, 0.957, 0.03);
  }
}

// Of the newest eight blocks the median: four of another noise are half of them.
TEST(WheelsetWatch, TheDifferenceIsThatOfTheNewestEightBlocks) {
  TwoWheelsets wheelsets;
  wheelsets.run(60'000);
  wheelsets.noise = 0.5;
  wheelsets.run(3 * 3000);
  EXPECT_NEAR(wheelsets.watch().difference_mps2() / 0.02, 0.957, 0.05);
  wheelsets.run(3000);
  EXPECT_GT(wheelsets.watch().difference_mps2(), 0.1);
  wheelsets.run(3000);
  EXPECT_NEAR(wheelsets.watch().difference_mps2() / 0.5, 0.957, 0.05);
}

// What gravity or an offset adds to either is no difference.
TEST(WheelsetWatch, AnOffsetIsNoDifference) {
  TwoWheelsets wheelsets;
  wheelsets.sensor1 = [](double x) { return x + 9.81; };
  wheelsets.sensor2 = [](double x) { return x - 3.0; };
  wheelsets.run(60'000);
  // The mean of ten seconds of noise still moves by a fiftieth of it.
  EXPECT_NEAR(wheelsets.watch().difference_mps2(), 0.02, 0.006);
  EXPECT_TRUE(wheelsets.log().faults().empty());
}

TEST(WheelsetWatch, DelaysByAFractionOfASample) {
  WheelsetWatch watch{300.0};
  FaultLog log{300.0};
  constexpr double kSamples = 17.4;
  const auto track = [](double n) { return std::sin(0.31 * n) + 2.0 * std::cos(1.3 * n); };
  for (std::int64_t n = 0; n < 90'000; ++n) {
    const auto x = static_cast<double>(n);
    watch.update(n, track(x), track(x - kSamples), log);
    if (n == 500) watch.set_delay(kSamples / 300.0);
    if (n % 3000 == 2999) watch.close_block(true, n, log);
  }
  EXPECT_LT(watch.difference_mps2(), 5e-3);
}

/// A sensor that reads less the more there is; its cubic part over the linear one.
std::function<double(double)> saturating(double part) {
  return [part](double x) { return x - part * (x * x * x - 3.0 * x); };
}

const Fault* saturation_of(TwoWheelsets& wheelsets) {
  wheelsets.run(33'000);
  for (const Fault& fault : wheelsets.log().faults())
    if (fault.kind == FaultKind::kSoftSaturation) return &fault;
  return nullptr;
}

TEST(WheelsetWatch, NamesTheWheelsetThatSaturates) {
  TwoWheelsets second;
  second.sensor2 = saturating(0.01);
  const Fault* fault = saturation_of(second);
  ASSERT_NE(fault, nullptr);
  EXPECT_EQ(fault->channel, FaultChannel::kWheelset2);
  EXPECT_NEAR(fault->size, 1.0, 0.2) << "per cent";
  EXPECT_NEAR(fault->time_s, 70.0, 0.1) << "six blocks after the one that tells the delay";
  TwoWheelsets first;
  first.sensor1 = saturating(0.01);
  fault = saturation_of(first);
  ASSERT_NE(fault, nullptr);
  EXPECT_EQ(fault->channel, FaultChannel::kWheelset1);
}

TEST(WheelsetWatch, SaturatesFromAFifthOfAPercentOn) {
  for (const auto& [part, named] : {std::pair{0.0015, false}, std::pair{0.0026, true}}) {
    TwoWheelsets wheelsets;
    wheelsets.noise = 0.005;
    wheelsets.sensor2 = saturating(part);
    EXPECT_EQ(saturation_of(wheelsets) != nullptr, named) << part;
  }
}

// Noise of the one hides what the other shows of it, which a saturation does both ways.
TEST(WheelsetWatch, WhatOneDirectionShowsIsNoSaturation) {
  for (const auto& [noise, named] : {std::pair{0.3, true}, std::pair{0.4, false}}) {
    TwoWheelsets wheelsets;
    wheelsets.noise = noise;
    wheelsets.sensor2 = saturating(0.05);
    wheelsets.run(150'000);
    EXPECT_EQ(saturation_of(wheelsets) != nullptr, named) << noise;
  }
}

TEST(WheelsetWatch, SixBlocksSinceAPauseTellASaturation) {
  TwoWheelsets wheelsets;
  wheelsets.sensor2 = saturating(0.01);
  const auto is_known = [&] { return wheelsets.log().has(FaultKind::kSoftSaturation); };
  wheelsets.run(18'010);  // five, after the one that tells the delay
  wheelsets.watch().restart();
  wheelsets.watch().set_delay(kDelay / 300.0);
  wheelsets.run(5 * 3000);
  EXPECT_FALSE(is_known());
  wheelsets.run(3000);
  EXPECT_TRUE(is_known());
}

TEST(WheelsetWatch, JudgesSaturationBySoundBlocks) {
  TwoWheelsets wheelsets;
  wheelsets.sensor2 = saturating(0.01);
  wheelsets.set_sound(false);
  EXPECT_EQ(saturation_of(wheelsets), nullptr);
}

/// What is named of wheelsets whose instants are off by `kOff` samples each, on a track of two
/// waves of so many radians a sample; over what it is.
double jitter_of_waves(double slow, double fast) {
  WheelsetWatch watch{300.0};
  FaultLog log{300.0};
  sim::Random random{9, sim::Stream::kFaults};
  constexpr double kOff = 0.05;  // samples, of either
  const auto track = [=](double n) { return std::sin(slow * n) + std::cos(fast * n); };
  for (std::int64_t n = 0; n < 120'000; ++n) {
    const auto x = static_cast<double>(n);
    const double one = track(x + kOff * random.normal());
    watch.update(n, one, track(x - kDelay + kOff * random.normal()), log);
    if (n == 500) watch.set_delay(kDelay / 300.0);
    if (n % 3000 == 2999) watch.close_block(true, n, log);
  }
  const Fault* const fault = log.find(FaultKind::kJitter, FaultChannel::kWheelsets);
  return fault == nullptr ? 0.0 : fault->size * 300.0 / kOff;
}

// By the slope of the track; of fast waves its central differences of sixth order miss some:
// 1 - (1.5 sin w - 0.3 sin 2 w + sin 3 w / 30) / w, 2 % at a fifth of the rate.
TEST(WheelsetWatch, NamesJitterOfTheTrack) {
  const auto slope = [](double w) {
    return (1.5 * std::sin(w) - 0.3 * std::sin(2.0 * w) + std::sin(3.0 * w) / 30.0) / w;
  };
  EXPECT_NEAR(slope(0.4 * std::numbers::pi), 0.98, 0.001);
  for (const auto& [slow, fast] : {std::pair{0.31, 0.83}, std::pair{1.5, 1.7}}) {
    const double seen =
        std::sqrt((std::pow(slow * slope(slow), 2) + std::pow(fast * slope(fast), 2)) /
                  (slow * slow + fast * fast));
    EXPECT_NEAR(jitter_of_waves(slow, fast) * seen, 1.0, 0.006) << slow;
  }
}

}  // namespace
}  // namespace dampline
