// SPDX-License-Identifier: MIT
#include "sim_hw/track.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace dampline::sim {
namespace {

constexpr std::size_t kWindow = 40000;

std::vector<double> hann() {
  std::vector<double> window(kWindow);
  for (std::size_t n = 0; n < kWindow; ++n) {
    window[n] = 1.0 - std::cos(2.0 * std::numbers::pi * static_cast<double>(n) / kWindow);
  }
  return window;
}

/// One-sided density of the slope at a wave number, from Hann windows of 400 m, half of it apart.
double slope_density(const std::vector<double>& slope, double wave_number) {
  static const std::vector<double> window = hann();
  double sum = 0.0;
  double energy = 0.0;
  int windows = 0;
  const auto turn = std::polar(1.0, -wave_number * Track::kGridM);
  for (std::size_t begin = 0; begin + kWindow <= slope.size(); begin += kWindow / 2) {
    std::complex<double> bin;
    std::complex<double> phase{1.0};
    energy = 0.0;
    for (std::size_t n = 0; n < kWindow; ++n) {
      energy += window[n] * window[n];
      bin += window[n] * slope[begin + n] * phase;
      phase *= turn;
    }
    sum += std::norm(bin);
    ++windows;
  }
  return sum / windows * Track::kGridM / (std::numbers::pi * energy);
}

TEST(Track, HasTheDensityOfOreB176) {
  const TrackConfig config;
  Track track{config, 5.0, 3};
  std::vector<double> slope;
  for (int i = 0; i < 4'000'000; ++i) {  // 40 km
    const double place = i * Track::kGridM;
    track.extend_to(place);
    slope.push_back(track.at(place).slope);
  }
  const double oc2 = config.corner_radpm * config.corner_radpm;
  const double or2 = config.long_wave_corner_radpm * config.long_wave_corner_radpm;
  for (const double om : {0.1, 0.3, 0.8, 1.5, 3.0, 6.0, 12.0}) {
    const double s = config.amplitude_m_rad * oc2 / ((om * om + or2) * (om * om + oc2)) * om * om;
    double measured = 0.0;  // about 200 windows, 5 bins: 4 % standard deviation
    for (int bin = -2; bin <= 2; ++bin) measured += slope_density(slope, om + bin * 0.03) / 5.0;
    EXPECT_NEAR(measured / s, 1.0, 0.15) << "wave number " << om;
  }
}

TEST(Track, HasACurvatureThatIsTheDerivativeOfItsSlope) {
  Track track{{}, 5.0, 1};
  track.extend_to(20.0);
  constexpr double kStep = 1e-5;
  for (const double place : {16.001, 17.3337, 19.2, 19.9951}) {
    const double difference =
        (track.at(place + kStep).slope - track.at(place - kStep).slope) / (2.0 * kStep);
    EXPECT_NEAR(difference, track.at(place).curvature_pm, 1e-6);
  }
}

TEST(Track, IsTheSameWhereverItIsLookedAtFrom) {
  Track at_once{{}, 3.0, 9};
  Track step_by_step{{}, 3.0, 9};
  at_once.extend_to(100.0);
  for (double place = 0.0; place < 100.0; place += 0.37) step_by_step.extend_to(place);
  step_by_step.extend_to(100.0);
  EXPECT_EQ(at_once.at(98.123).slope, step_by_step.at(98.123).slope);
  EXPECT_EQ(at_once.at(98.123).curvature_pm, step_by_step.at(98.123).curvature_pm);
}

TEST(Track, AddsShortWavesOfTheWantedAccelerationInTheirBand) {
  TrackConfig config;
  config.amplitude_m_rad = 1e-30;
  config.short_wave_mps2 = 2.0;
  Track track{config, 3.0, 5};
  const double square = config.nominal_speed_mps * config.nominal_speed_mps;
  std::vector<double> slope;
  double sum = 0.0;
  constexpr int kPoints = 1'000'000;
  for (int i = 0; i < kPoints; ++i) {
    const double place = i * Track::kGridM;
    track.extend_to(place);
    const TrackPoint point = track.at(place);
    sum += std::pow(point.curvature_pm * square, 2);
    slope.push_back(point.slope);
  }
  EXPECT_NEAR(std::sqrt(sum / kPoints), 2.0, 0.06);
  const auto acceleration_density = [&](double hz) {
    const double om = 2.0 * std::numbers::pi * hz / config.nominal_speed_mps;
    double mean = 0.0;
    for (int bin = -3; bin <= 3; ++bin) mean += slope_density(slope, om + bin * 0.03) / 7.0;
    return om * om * mean;
  };
  const double middle = acceleration_density(60.0);
  EXPECT_NEAR(acceleration_density(45.0) / middle, 0.5, 0.1);
  EXPECT_NEAR(acceleration_density(75.0) / middle, 0.5, 0.1);
  EXPECT_LT(acceleration_density(20.0) / middle, 0.05);
  EXPECT_LT(acceleration_density(140.0) / middle, 0.05);
}

}  // namespace
}  // namespace dampline::sim
