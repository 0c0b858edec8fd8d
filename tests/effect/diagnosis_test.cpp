// SPDX-License-Identifier: MIT
#include "dampline/effect/diagnosis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

namespace dampline::effect {
namespace {

/// Fed with a deflection of one tone, now and then at a standstill.
class OneTone {
 public:
  explicit OneTone(double rms_m, const Grids& grids = {})
      : rms_m_{rms_m}, diagnosis_{std::make_unique<Diagnosis>(EstimatorConfig{}, grids)} {}

  void run(int samples, bool still = false) {
    for (int i = 0; i < samples; ++i, ++tick_) {
      const double turn = 2.0 * 3.141592653589793 * 3.0 * static_cast<double>(tick_) / 300.0;
      const double amplitude = std::sqrt(2.0) * rms_m_;
      Sample sample;
      sample.tick = tick_;
      UpdateResult result;
      result.has_motion = true;
      result.motion.tick = tick_;
      result.motion.deflection_m = still ? 0.0 : amplitude * std::sin(turn);
      result.motion.velocity_mps = still ? 0.0 : 18.85 * amplitude * std::cos(turn);
      result.motion.still = still;
      diagnosis_->update(sample, result);
    }
  }
  void skip(int ticks) { tick_ += ticks; }
  Diagnosis& diagnosis() { return *diagnosis_; }
  [[nodiscard]] std::int64_t tick() const { return tick_; }

 private:
  double rms_m_;
  std::unique_ptr<Diagnosis> diagnosis_;
  std::int64_t tick_{0};
};

// Half powers of two of a millimetre.
TEST(Diagnosis, LearnsTheSizeOfTheDeflectionInEightSeconds) {
  for (const auto& [rms_m, scale_m] :
       {std::pair{1.1e-3, 1e-3}, std::pair{1.3e-3, std::sqrt(2.0) * 1e-3},
        std::pair{2.9e-3, std::sqrt(8.0) * 1e-3}, std::pair{0.26e-3, 0.25e-3}}) {
    OneTone tone{rms_m};
    tone.run(500, true);
    tone.run(2399);
    EXPECT_EQ(tone.diagnosis().scale_m(), 0.0) << "what stands still does not count";
    tone.run(1);
    EXPECT_NEAR(tone.diagnosis().scale_m(), scale_m, 1e-12);
    tone.run(1000);
    EXPECT_NEAR(tone.diagnosis().scale_m(), scale_m, 1e-12) << "and stays";
  }
  OneTone known{5e-3, Grids{.scale_m = 2e-3}};
  EXPECT_EQ(known.diagnosis().scale_m(), 2e-3);
}

// Columns are those of the sample before; the first ones and those behind a gap have to wait.
TEST(Diagnosis, MakesTheColumnsOfTheSampleBefore) {
  OneTone tone{2e-3, Grids{.scale_m = 2e-3}};
  tone.run(20);
  EXPECT_EQ(tone.diagnosis().column_tick(), tone.tick() - 2);
  tone.skip(50);
  tone.run(1);
  EXPECT_EQ(tone.diagnosis().column_tick(), -1);
  tone.run(20);
  EXPECT_EQ(tone.diagnosis().column_tick(), tone.tick() - 2);
}

TEST(Diagnosis, MeansAreOfTheSamplesThatMove) {
  OneTone tone{2e-3, Grids{.scale_m = 2e-3}};
  tone.run(1);
  for (int i = 0; i < 5; ++i) {
    tone.run(3000);
    tone.run(1000, true);
  }
  EXPECT_NEAR(tone.diagnosis().deflection_rms_m(), 2e-3, 1e-6);
  EXPECT_NEAR(tone.diagnosis().velocity_rms_mps(), 18.85 * 2e-3, 2e-5);
  EXPECT_NEAR(tone.diagnosis().velocity_error().velocity_rms_mps, 18.85 * 2e-3, 2e-5);
}

}  // namespace
}  // namespace dampline::effect
