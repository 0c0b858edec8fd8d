// SPDX-License-Identifier: MIT
// The delay between the wheelsets as the speed changes: from whole samples to whole samples.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <vector>

#include "dampline/guard/spectral_guard.hpp"
#include "sim_hw/noise.hpp"

namespace dampline {
namespace {

/// A track of tones up to 90 Hz, wheelset 2 later by any time, and a frame that follows the slowest
/// of them alone.
class TonesOfTrack {
 public:
  explicit TonesOfTrack(const GuardConfig& config = {})
      : guard_{std::make_unique<SpectralGuard>(config)} {
    for (int i = 0; i < 40; ++i) tones_.push_back({1.2 + 2.24 * i, 6.28 * random_.uniform()});
  }
  void run(double length_s, const std::function<double(double)>& late_s) {
    for (int i = 0; i < static_cast<int>(length_s * 300.0); ++i, ++tick_) {
      const double time_s = static_cast<double>(tick_) / 300.0;
      guard_->push(tick_,
                   {0.3 * tone(tones_[0], time_s) + 0.02 * random_.normal(),
                    track(time_s) + 0.01 * random_.normal(),
                    track(time_s - late_s(time_s)) + 0.01 * random_.normal()},
                   false);
      guard_->advance(*log_, inputs);
    }
  }
  void set_jump() { guard_->set_jump(tick_); }
  [[nodiscard]] std::span<const Fault> faults() const { return log_->faults(); }
  [[nodiscard]] double delay_s() const { return guard_->delay_s(); }
  GuardInputs inputs{};

 private:
  struct Tone {
    double hz, phase;
  };
  [[nodiscard]] static double tone(const Tone& of, double time_s) {
    return std::cos(2.0 * std::numbers::pi * of.hz * time_s + of.phase);
  }
  [[nodiscard]] double track(double time_s) const {
    double sum = 0.0;
    for (const Tone& one : tones_) sum += tone(one, time_s);
    return sum;
  }
  sim::Random random_{4, sim::Stream::kTrack};
  std::vector<Tone> tones_;
  std::unique_ptr<SpectralGuard> guard_;
  std::unique_ptr<FaultLog> log_{std::make_unique<FaultLog>(300.0)};
  std::int64_t tick_{0};
};

// 23.6 to 25.4 samples: a change of speed by 7 %. The frame says nothing of it.
TEST(SpectralGuard, ADelayThatCreepsAcrossWholeSamplesIsARide) {
  TonesOfTrack track;
  const auto late_s = [](double time_s) {
    return (23.6 + 1.8 * std::clamp((time_s - 100.0) / 60.0, 0.0, 1.0)) / 300.0;
  };
  track.run(260.0, late_s);
  EXPECT_TRUE(track.faults().empty());
  EXPECT_EQ(track.inputs.speed_changes, 1U);
  EXPECT_NEAR(track.delay_s(), 25.4 / 300.0, 2e-5);
}

// The block that holds the leap is of no use: that the wheelsets moved apart at once tells.
TEST(SpectralGuard, ADelayThatLeapsIsAStepWhereTheWheelsetsJumped) {
  for (const bool jumped : {false, true}) {
    TonesOfTrack track;
    const auto late_s = [](double time_s) { return (time_s < 120.0 ? 23.6 : 25.4) / 300.0; };
    track.run(120.0, late_s);
    if (jumped) track.set_jump();
    track.run(100.0, late_s);
    ASSERT_EQ(track.faults().size(), jumped ? 1U : 0U);
    EXPECT_EQ(track.inputs.speed_changes, jumped ? 0U : 1U);
    if (!jumped) continue;
    EXPECT_EQ(track.faults()[0].kind, FaultKind::kTimingStep);
    EXPECT_EQ(track.faults()[0].channel, FaultChannel::kWheelsets);
    EXPECT_NEAR(track.faults()[0].size, 1.8 / 300.0, 2e-5);
    EXPECT_NEAR(track.faults()[0].time_s, 120.0, 10.0);
  }
}

}  // namespace
}  // namespace dampline
