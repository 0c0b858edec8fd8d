// SPDX-License-Identifier: MIT
#include "dampline/guard/jitter_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "sim_hw/noise.hpp"

namespace dampline {
namespace {

constexpr double kJitterRateHz = 300.0;

struct PairConfig {
  double off{0.0};     ///< samples
  double differ{0.0};  ///< of what they do not share, over the acceleration
  double noise{1e-3};
  double gain{0.0};
  double delay{0.0};
  int samples{6000};
};

/// Blocks of two wheelsets that see the same, each at instants that are off by so many samples.
class Wheelsets {
 public:
  explicit Wheelsets(const PairConfig& config) : config_{config} {}

  void block(bool chunk_is_sound = true, bool block_is_sound = true) {
    for (int i = 0; i < config_.samples; ++i) {
      const double a = random_.normal();
      const double slope = 0.7 * random_.normal();
      const double moved = std::sqrt(2.0) * config_.off * random_.normal();
      const double rough = config_.differ * (a * random_.normal() + slope * random_.normal() / 0.7);
      watch_.update(a, slope,
                    config_.gain * a + (config_.delay + moved) * slope + rough +
                        config_.noise * random_.normal());
    }
    watch_.end_chunk(chunk_is_sound);
    watch_.close_block(block_is_sound, ++blocks_ * 3000, *log_);
  }
  void blocks(int count) {
    for (int i = 0; i < count; ++i) block();
  }
  void restart() { watch_.restart(); }
  void open(int count) {
    for (int i = 0; i < count; ++i) watch_.update(random_.normal(), random_.normal(), 50.0);
    watch_.end_chunk(true);
  }
  [[nodiscard]] const Fault* fault() const {
    return log_->find(FaultKind::kJitter, FaultChannel::kWheelsets);
  }

 private:
  PairConfig config_;
  sim::Random random_{7, sim::Stream::kFaults};
  std::unique_ptr<FaultLog> log_{std::make_unique<FaultLog>(kJitterRateHz)};
  JitterWatch watch_{kJitterRateHz};
  std::int64_t blocks_{0};
};

TEST(JitterWatch, NamesTheDeviationOfEachWheelsetsInstants) {
  for (const double off : {0.05, 0.2}) {
    Wheelsets wheelsets{{.off = off}};
    wheelsets.blocks(12);
    ASSERT_NE(wheelsets.fault(), nullptr);
    EXPECT_NEAR(wheelsets.fault()->size * kJitterRateHz / off, 1.0, 0.04);
    EXPECT_EQ(wheelsets.fault()->time_s, 7 * 10.0) << "six blocks tell, twice in a row";
    EXPECT_EQ(wheelsets.fault()->count, 6U);
  }
}

TEST(JitterWatch, IsFromFiftyMicrosecondsOn) {
  Wheelsets less{{.off = 0.0144}};  // 48 us
  less.blocks(20);
  EXPECT_EQ(less.fault(), nullptr);
  Wheelsets more{{.off = 0.0157}};  // 52 us
  more.blocks(20);
  EXPECT_NE(more.fault(), nullptr);
}

TEST(JitterWatch, TakesAGainAndADelayOut) {
  Wheelsets wheelsets{{.off = 0.05, .gain = 0.3, .delay = -0.4}};
  wheelsets.blocks(20);  // what the first block knows nothing of is one of twenty
  ASSERT_NE(wheelsets.fault(), nullptr);
  Wheelsets none{{.gain = 0.3, .delay = -0.4}};
  none.blocks(20);
  EXPECT_EQ(none.fault(), nullptr);
  EXPECT_NEAR(wheelsets.fault()->size * kJitterRateHz / 0.05, 1.0, 0.1);
}

// What grows with the acceleration as much as with its slope is not jitter.
TEST(JitterWatch, TakesWheelsThatDifferForNone) {
  Wheelsets wheelsets{{.differ = 0.2}};
  wheelsets.blocks(20);
  EXPECT_EQ(wheelsets.fault(), nullptr);
}

TEST(JitterWatch, NoiseAloneIsNone) {
  Wheelsets wheelsets{{.noise = 1.0}};
  wheelsets.blocks(20);
  EXPECT_EQ(wheelsets.fault(), nullptr);
}

TEST(JitterWatch, NeedsThreeHundredSamplesOfABlock) {
  Wheelsets few{{.off = 0.3, .noise = 0.0, .samples = 299}};
  few.blocks(60);
  EXPECT_EQ(few.fault(), nullptr);
  Wheelsets enough{{.off = 0.3, .noise = 0.0, .samples = 300}};
  enough.blocks(60);
  EXPECT_NE(enough.fault(), nullptr);
}

TEST(JitterWatch, DropsWhatIsNotSound) {
  Wheelsets wheelsets{{.off = 0.1}};
  for (int i = 0; i < 10; ++i) {
    wheelsets.block(false, true);
    wheelsets.block(true, false);
  }
  EXPECT_EQ(wheelsets.fault(), nullptr);
  wheelsets.blocks(6);
  EXPECT_EQ(wheelsets.fault(), nullptr) << "of an unsound block nothing is left";
  wheelsets.block();
  EXPECT_NE(wheelsets.fault(), nullptr);
}

TEST(JitterWatch, ForgetsTheOpenBlockAtARestart) {
  Wheelsets wheelsets{{.off = 0.1}};
  for (int i = 0; i < 12; ++i) {
    wheelsets.open(5000);
    wheelsets.restart();
    wheelsets.block();
  }
  ASSERT_NE(wheelsets.fault(), nullptr);
  EXPECT_NEAR(wheelsets.fault()->size * kJitterRateHz / 0.1, 1.0, 0.05);
}

}  // namespace
}  // namespace dampline
