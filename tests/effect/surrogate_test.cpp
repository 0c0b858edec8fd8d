// SPDX-License-Identifier: MIT
#include "dampline/effect/surrogate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <memory>
#include <vector>

namespace dampline::effect {
namespace {

constexpr double kSurrogateHz = 300.0;

Sample wheelsets_at(std::int64_t tick, double wheelset_mps2) {
  Sample s;
  s.tick = tick;
  s.accel_mps2 = {99.0, wheelset_mps2, wheelset_mps2};  // the frame's own is not looked at
  return s;
}

TEST(Surrogate, AnswersATonesAsALinearOscillatorDoes) {
  SurrogateConfig config;
  config.stiffness_per_s2 = 141.4;
  config.viscous_per_s = 3.0;
  Surrogate surrogate{config};
  const double w = 2.0 * M_PI * 2.3;
  // y'' + 2 c y' + 2 k y = -(a1 + a2); z_b'' = -(k y + c y')
  const std::complex<double> y = -2.0 / std::complex<double>{2.0 * 141.4 - w * w, 2.0 * 3.0 * w};
  const std::complex<double> expected = -y * std::complex<double>{141.4, 3.0 * w};
  double worst = 0.0;
  for (int n = 0; n < 6000; ++n) {
    const auto out = surrogate.next(wheelsets_at(n, std::cos(w * n / kSurrogateHz)));
    if (n < 3000 || !out) continue;
    const double t = static_cast<double>(out->tick) / kSurrogateHz;
    const double truth = (expected * std::polar(1.0, w * t)).real();
    worst = std::max(worst, std::abs(out->accel_mps2[0] - truth));
    EXPECT_NEAR(out->accel_mps2[1], std::cos(w * t), 1e-9);
  }
  EXPECT_LT(worst, 1e-3 * std::abs(expected));
}

TEST(Surrogate, SticksUntilTheInputBreaksItLoose) {
  SurrogateConfig config;
  config.stiffness_per_s2 = 141.4;
  config.coulomb_mps2 = 0.5;
  Surrogate surrogate{config};
  // Below the break-away level the frame follows the wheelsets: z_b'' = (z_1'' + z_2'') / 2.
  double last = 0.0;
  for (int n = 0; n < 900; ++n) {
    const auto out =
        surrogate.next(wheelsets_at(n, 0.3 * std::sin(2.0 * M_PI * 3.0 * n / kSurrogateHz)));
    if (out) last = out->accel_mps2[0] - out->accel_mps2[1];
    if (n <= 300) continue;
    EXPECT_NEAR(last, 0.0, 0.02);
  }
}

TEST(Surrogate, HasTheNoiseAndTheResolutionOfTheSensors) {
  SurrogateConfig config;
  config.stiffness_per_s2 = 141.4;
  config.noise_mps2 = {0.03, 0.03, 0.03};
  config.step_mps2 = {0.02, 0.02, 0.02};
  Surrogate surrogate{config};
  double squares = 0.0;
  int count = 0;
  for (int n = 0; n < 20000; ++n) {
    const auto out = surrogate.next(wheelsets_at(n, 0.0));
    if (!out) continue;
    const double codes = out->accel_mps2[1] / 0.02;
    EXPECT_NEAR(codes, std::round(codes), 1e-9);
    squares += out->accel_mps2[1] * out->accel_mps2[1];
    ++count;
  }
  EXPECT_NEAR(std::sqrt(squares / count), 0.03, 0.001);
}

TEST(Surrogate, KeepsGapsAndWhatIsNoNumber) {
  Surrogate surrogate{SurrogateConfig{.stiffness_per_s2 = 141.4}};
  int made = 0;
  for (int n = 0; n < 120; ++n) {
    const bool bad = n == 60;
    const auto out =
        surrogate.next(wheelsets_at(n, bad ? std::numeric_limits<double>::quiet_NaN() : 0.1 * n));
    if (!out) continue;
    EXPECT_EQ(std::isnan(out->accel_mps2[1]), bad);
    EXPECT_TRUE(out->tick <= 36 || out->tick == 60 || out->tick >= 85) << out->tick;
    ++made;
  }
  EXPECT_EQ(made, 13 + 1 + 12);  // 24 samples to either side of what is between two
}

/// A tone that grows for a second.
double growing_tone(double t_s) {
  return 2.0 * std::sin(2.0 * M_PI * 2.1 * t_s) * std::min(1.0, t_s);
}

/// The worst error of a surrogate's frame, of its rms, beside the same motion by small steps of
/// another kind. `force`: of y, v and the stretch of a spring that relaxes over 0.03 s.
template <class Force>
double error_beside(const SurrogateConfig& config, const Force& force) {
  constexpr int kSteps = 400;  // a sample
  constexpr double kSmallS = 1.0 / (kSurrogateHz * kSteps);
  Surrogate surrogate{config};
  std::vector<double> truth;
  double y = 0.0, v = 0.0, stretch = 0.0, squares = 0.0, worst = 0.0;
  for (int n = 0; n < kSteps * 2400; ++n) {
    const double frame_mps2 = -force(y, v, stretch);
    if (n % kSteps == 0) truth.push_back(frame_mps2);
    squares += frame_mps2 * frame_mps2 / (kSteps * 2400);
    v += kSmallS * 2.0 * (frame_mps2 - growing_tone(kSmallS * n));
    y += kSmallS * v;
    stretch += kSmallS * (v - stretch / 0.03);
  }
  for (int n = 0; n < 2399; ++n) {
    const auto out = surrogate.next(wheelsets_at(n, growing_tone(n / kSurrogateHz)));
    if (!out || n < 300) continue;
    worst =
        std::max(worst, std::abs(out->accel_mps2[0] - truth[static_cast<std::size_t>(out->tick)]));
  }
  return worst / std::sqrt(squares);
}

TEST(Surrogate, HasTheSpringsThatWereFound) {
  SurrogateConfig config;
  config.stiffness_per_s2 = 141.4;
  config.viscous_per_s = 3.0;
  const auto error = [&](const auto& bent) {
    return error_beside(config,
                        [&](double y, double v, double) { return 141.4 * y + 3.0 * v + bent(y); });
  };
  config.found.cube_per_m2_s2 = 4e5;
  EXPECT_LT(error([](double y) { return 4e5 * y * y * y; }), 0.01);
  config.found = {.square_per_m_s2 = 2e3};
  EXPECT_LT(error([](double y) { return 2e3 * y * y; }), 0.01);
  config.found = {.magnitude_per_s2 = 30.0};
  EXPECT_LT(error([](double y) { return 30.0 * std::abs(y); }), 0.01);
  config.found = {.stop_up_per_s2 = 200.0, .stop_down_per_s2 = 100.0, .stop_m = 0.01};
  EXPECT_LT(error([](double y) {
              return 200.0 * std::max(y - 0.01, 0.0) - 100.0 * std::max(-y - 0.01, 0.0);
            }),
            0.01);
}

TEST(Surrogate, HasTheDampingThatWasFound) {
  SurrogateConfig config;
  config.stiffness_per_s2 = 141.4;
  config.found = {.viscous_up_per_s = 4.0, .viscous_down_per_s = 2.0};
  EXPECT_LT(error_beside(config, [](double y, double v,
                                    double) { return 141.4 * y + (v > 0.0 ? 4.0 : 2.0) * v; }),
            0.01);
  config.found = {.quadratic_per_m = 20.0};
  EXPECT_LT(error_beside(config, [](double y, double v,
                                    double) { return 141.4 * y + 20.0 * v * std::abs(v); }),
            0.01);
  config.viscous_per_s = 1.0;
  config.found = {.relaxing_per_s2 = 80.0, .relaxing_s = 0.03};
  EXPECT_LT(
      error_beside(config, [](double y, double v, double x) { return 141.4 * y + v + 80.0 * x; }),
      0.01);
}

TEST(Surrogate, HasTheFrictionThatWasFound) {
  SurrogateConfig config;
  config.stiffness_per_s2 = 141.4;
  config.coulomb_mps2 = 0.4;
  const auto error = [&](const auto& level) {
    return error_beside(config, [&](double y, double v, double) {
      return 141.4 * y + 0.4 * level(y, v) * std::tanh(v / 5e-4);
    });
  };
  config.found.grows_per_m = 20.0;
  EXPECT_LT(error([](double y, double) { return 1.0 + 20.0 * y; }), 0.05);
  config.found = {.widens_per_m = 30.0};
  EXPECT_LT(error([](double y, double) { return 1.0 + 30.0 * std::abs(y); }), 0.05);
  config.found = {.falls_mps2 = 0.12, .falls_over_mps = 0.02};
  EXPECT_LT(error([](double, double v) { return 1.0 + 0.3 * std::exp(-std::abs(v) / 0.02); }),
            0.05);
}

// Beyond 7.7 mm the cubic part would push outwards.
TEST(Surrogate, OfASpringThatSoftensStaysWhereItIs) {
  SurrogateConfig config;
  config.stiffness_per_s2 = 141.4;
  config.coulomb_mps2 = 0.4;
  config.found.cube_per_m2_s2 = -2.4e6;
  Surrogate surrogate{config};
  for (int n = 0; n < 3000; ++n) {
    const auto out = surrogate.next(wheelsets_at(n, growing_tone(n / kSurrogateHz)));
    if (!out) continue;
    ASSERT_LT(std::abs(out->accel_mps2[0]), 2.0) << n;
  }
}

TEST(Surrogate, BuildsItsFrictionUpOverDahlsLength) {
  SurrogateConfig config;
  config.stiffness_per_s2 = 141.4;
  config.memory = {false, 0.4, 0.6e-3};
  Surrogate surrogate{config};
  // A slow tone, so that 2 z_b'' = input + y'' and the loop of f(y) is Dahl's closed form:
  // f = +-F (1 - c e^(-+(y - y_r) / r)) from a reversal at y_r with f = f_r.
  double y = 0.0;
  double v = 0.0;
  double zeta = 0.0;
  double worst = 0.0;
  const double step_s = 1.0 / (kSurrogateHz * 400.0);
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
    const auto out = surrogate.next(wheelsets_at(n, input(n / kSurrogateHz)));
    if (!out || n < 300) continue;
    worst =
        std::max(worst, std::abs(out->accel_mps2[0] - truth[static_cast<std::size_t>(out->tick)]));
  }
  EXPECT_LT(worst, 0.01);
}

TEST(Surrogate, HasNoFrictionInsideItsPlay) {
  SurrogateConfig config;
  config.stiffness_per_s2 = 141.4;
  config.memory = {true, 0.4, 4e-3};
  Surrogate surrogate{config};
  const double w = 2.0 * M_PI * 1.0;
  // 1.2 mm of deflection stay inside the gap: the spring alone answers, so nothing damps.
  const double amplitude = 0.08;
  double peak = 0.0;
  for (int n = 0; n < 3000; ++n) {
    const auto out = surrogate.next(wheelsets_at(n, amplitude * std::sin(w * n / kSurrogateHz)));
    if (out && n > 2000) peak = std::max(peak, std::abs(out->accel_mps2[0]));
  }
  const double forced = amplitude * 2.0 * 141.4 / (2.0 * 141.4 - w * w);
  EXPECT_GT(peak, forced);  // what the start set swinging goes on
  EXPECT_LT(peak, 0.4);
  // 5 times as much takes the gap up, and friction damps.
  Surrogate struck{config};
  double least = 1e9;
  for (int n = 0; n < 3000; ++n) {
    const auto out =
        struck.next(wheelsets_at(n, n < 300 ? 2.0 * std::sin(w * n / kSurrogateHz) : 0.0));
    if (out && n > 2700) least = std::min(least, std::abs(out->accel_mps2[0]));
    if (out && n > 2700) peak = std::max(peak, std::abs(out->accel_mps2[0]));
  }
  EXPECT_LT(peak, 141.4 * 2.0e-3 + 0.05);  // the free swing that is left fits into the gap
}

// A push sends the mass to the end of its play at v: y'' = -2 F s / s_0 stops it within a quarter
// of a swing, where the force is v sqrt(F / (2 s_0)) of one unit of mass; an end that does not
// yield answers with all of F.
TEST(Surrogate, TheEndOfAPlayYields) {
  constexpr double kForceMps2 = 0.4;
  constexpr double kYieldsM = 0.2e-3;
  constexpr double kPushMps2 = 0.2;  // on both wheelsets, for three samples
  const double v_mps = 2.0 * kPushMps2 * 3.0 / kSurrogateHz;
  SurrogateConfig config;
  const auto peak_at = [&](double width_mps) {
    config.memory = {true, kForceMps2, 2e-3, width_mps};
    Surrogate surrogate{config};
    double peak = 0.0;
    for (int n = 0; n < 400; ++n) {
      const bool pushes = n >= 100 && n < 103;
      const auto out = surrogate.next(wheelsets_at(n, pushes ? -kPushMps2 : 0.0));
      if (out) peak = std::max(peak, std::abs(out->accel_mps2[0]));
    }
    return peak;
  };
  const double own_mps = std::sqrt(2.0 * kForceMps2 * kYieldsM);
  EXPECT_NEAR(peak_at(std::hypot(own_mps, kInnerWidthMps)),
              v_mps * std::sqrt(0.5 * kForceMps2 / kYieldsM), 0.03 * kForceMps2);
  EXPECT_GT(peak_at(kInnerWidthMps), 0.15) << "as far as samples show a leap of 5 ms";
}

}  // namespace
}  // namespace dampline::effect
