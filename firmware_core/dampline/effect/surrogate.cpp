// SPDX-License-Identifier: MIT
#include "dampline/effect/surrogate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dampline/effect/columns.hpp"
#include "dampline/motion/anti_alias.hpp"
#include "dampline/motion/fractional_delay.hpp"

namespace dampline::effect {
namespace {

constexpr double kLawWidthMps = 5e-4;  // sign v as tanh(v / width)
constexpr double kRamp = 0.05;         // of a gap: where the force rises
constexpr double kMostGivenBack = 4.0;
constexpr std::size_t kDesignBins = 512;
constexpr std::uint64_t kStream = 3;  // of random numbers
constexpr double kSteepest = 0.8;     // slope times step that Runge-Kutta is trusted with

ButterworthLowPass<kChannels> filter_of(const SurrogateConfig& config, int fine) {
  return {config.low_pass_hz > 0.0 ? config.low_pass_hz : 1.0, fine * config.sample_rate_hz};
}

/// What the sensors' filter took of a motion, to be given back: the surrogate is seen through it
/// again.
double given_back(const SurrogateConfig& config, double f_hz) {
  if (config.input_low_pass_hz <= 0.0) return 1.0;
  return std::min(std::sqrt(butterworth_loss(f_hz / config.input_low_pass_hz, 4)), kMostGivenBack);
}

/// Over what the force of an end rises.
double ramp_of(const FrictionMemory& memory) {
  return std::max(kRamp * memory.length_m, end_yields_m(memory.width_mps, memory.force_mps2));
}

bool is_number(const Sample& sample) {
  return std::all_of(sample.accel_mps2.begin(), sample.accel_mps2.end(),
                     [](double a) { return std::isfinite(a); });
}

}  // namespace

Surrogate::Surrogate(const SurrogateConfig& config)
    : config_{config},
      finds_{config.found != FoundForce{}},
      ramp_m_{ramp_of(config.memory)},
      filter_{filter_of(config, kFine)},
      noise_{config.seed, kStream} {
  set_taps();
  if (config.memory.is_play) config_.memory.length_m += 0.5 * ramp_m_;
  const double sliding_mps2 =
      config.coulomb_mps2 + (config.memory.is_play ? config.memory.force_mps2 : 0.0);
  const double slope = 2.0 * sliding_mps2 / kLawWidthMps;
  parts_ = 1 + static_cast<int>(slope / (kSteepest * kFine * config.sample_rate_hz));
  for (std::size_t c = 0; c < kChannels; ++c) {
    const double rounding = config.step_mps2[c] * config.step_mps2[c] / 12.0;
    white_mps2_[c] =
        std::sqrt(std::max(config.noise_mps2[c] * config.noise_mps2[c] - rounding, 0.0));
  }
}

void Surrogate::set_taps() {
  std::array<double, kDesignBins> turn{};  // of a sample, at each frequency
  std::array<double, kDesignBins> gain{};
  for (std::size_t k = 0; k < kDesignBins; ++k) {
    const double f = 0.5 * (static_cast<double>(k) + 0.5) / kDesignBins;
    turn[k] = 2.0 * std::numbers::pi * f;
    gain[k] = given_back(config_, f * config_.sample_rate_hz);
  }
  for (int part = 0; part <= kFine; ++part) {
    auto& taps = taps_[static_cast<std::size_t>(part)];
    const double place = kHalf - 1 + static_cast<double>(part) / kFine;
    double sum = 0.0;
    for (std::size_t i = 0; i < kTaps; ++i) {
      const double x = static_cast<double>(i) - place;
      double tap = 0.0;
      for (std::size_t k = 0; k < kDesignBins; ++k) tap += gain[k] * std::cos(turn[k] * x);
      taps[i] = tap * blackman(x / kHalf);
      sum += taps[i];
    }
    for (double& tap : taps) tap /= sum;
  }
}

/// Friction with memory, of its level.
double Surrogate::remembered(const Motion& m) const noexcept {
  const FrictionMemory& law = config_.memory;
  if (!law.is_play) return m.zeta;
  const double travelled_m =
      std::copysign(1.0, m.velocity_mps) * (m.deflection_m - piston_m_) + 0.5 * law.length_m;
  const double share = 1.0 - (law.length_m - travelled_m) / ramp_m_;
  return std::clamp(share, 0.0, 1.0) * std::tanh(m.velocity_mps / kLawWidthMps);
}

/// A spring that softens never pushes outwards: beyond what it was seen to do it holds nothing.
double Surrogate::elastic_mps2(const Motion& m) const noexcept {
  const FoundForce& f = config_.found;
  const double y = m.deflection_m;
  const double bent =
      (config_.stiffness_per_s2 + (f.square_per_m_s2 + f.cube_per_m2_s2 * y) * y) * y +
      f.magnitude_per_s2 * std::abs(y) + f.stop_up_per_s2 * std::max(y - f.stop_m, 0.0) -
      f.stop_down_per_s2 * std::max(-y - f.stop_m, 0.0);
  return y > 0.0 ? std::max(bent, 0.0) : std::min(bent, 0.0);
}

/// Nor does a friction that falls drive.
double Surrogate::friction_mps2(const Motion& m) const noexcept {
  const FoundForce& f = config_.found;
  const double y = m.deflection_m;
  double level = config_.coulomb_mps2 * (1.0 + f.grows_per_m * y + f.widens_per_m * std::abs(y));
  if (f.falls_mps2 != 0.0)
    level += f.falls_mps2 * std::exp(-std::abs(m.velocity_mps) / f.falls_over_mps);
  return std::max(level, 0.0) * std::tanh(m.velocity_mps / kLawWidthMps);
}

double Surrogate::frame_mps2(const Motion& m) const noexcept {
  const FoundForce& f = config_.found;
  const double v = m.velocity_mps;
  const double memory =
      config_.memory.force_mps2 > 0.0 ? config_.memory.force_mps2 * remembered(m) : 0.0;
  if (!finds_)
    return -config_.stiffness_per_s2 * m.deflection_m - config_.viscous_per_s * v -
           config_.coulomb_mps2 * std::tanh(v / kLawWidthMps) - memory;
  const double damping_per_s = config_.viscous_per_s +
                               (v > 0.0 ? f.viscous_up_per_s : f.viscous_down_per_s) +
                               f.quadratic_per_m * std::abs(v);
  return -elastic_mps2(m) - damping_per_s * v - friction_mps2(m) - f.relaxing_per_s2 * m.stretch_m -
         memory;
}

/// y'' = 2 z_b'' - (z_1'' + z_2''); zeta' = (v - zeta |v|) / r
Surrogate::Motion Surrogate::rate(const Motion& m, double input_mps2) const noexcept {
  const bool builds_up = config_.memory.force_mps2 > 0.0 && !config_.memory.is_play;
  const double v = m.velocity_mps;
  return {v, 2.0 * frame_mps2(m) - input_mps2,
          builds_up ? (v - m.zeta * std::abs(v)) / config_.memory.length_m : 0.0,
          finds_ ? v - m.stretch_m / config_.found.relaxing_s : 0.0};
}

void Surrogate::step(double from_mps2, double to_mps2, double step_s) noexcept {
  const auto moved = [this](const Motion& by, double s) {
    return Motion{motion_.deflection_m + s * by.deflection_m,
                  motion_.velocity_mps + s * by.velocity_mps, motion_.zeta + s * by.zeta,
                  motion_.stretch_m + s * by.stretch_m};
  };
  const double middle_mps2 = 0.5 * (from_mps2 + to_mps2);
  const Motion a = rate(motion_, from_mps2);
  const Motion b = rate(moved(a, 0.5 * step_s), middle_mps2);
  const Motion c = rate(moved(b, 0.5 * step_s), middle_mps2);
  const Motion d = rate(moved(c, step_s), to_mps2);
  const auto mean = [](double p, double q, double r, double s) {
    return (p + 2.0 * q + 2.0 * r + s) / 6.0;
  };
  motion_ = moved({mean(a.deflection_m, b.deflection_m, c.deflection_m, d.deflection_m),
                   mean(a.velocity_mps, b.velocity_mps, c.velocity_mps, d.velocity_mps),
                   mean(a.zeta, b.zeta, c.zeta, d.zeta),
                   mean(a.stretch_m, b.stretch_m, c.stretch_m, d.stretch_m)},
                  step_s);
  const double reach_m = 0.5 * config_.memory.length_m;
  piston_m_ = std::clamp(piston_m_, motion_.deflection_m - reach_m, motion_.deflection_m + reach_m);
}

/// The wheelsets between the middle two of the samples.
std::array<double, 2> Surrogate::between(int part) const noexcept {
  const auto& taps = taps_[static_cast<std::size_t>(part)];
  std::array<double, 2> out{};
  for (std::size_t i = 0; i < kTaps; ++i) {
    out[0] += taps[i] * held_[i].accel_mps2[1];
    out[1] += taps[i] * held_[i].accel_mps2[2];
  }
  return out;
}

Sample Surrogate::seen(const std::array<double, kChannels>& accel_mps2) {
  Sample out = held_[kHalf];
  for (std::size_t c = 0; c < kChannels; ++c) {
    double noisy = accel_mps2[c] + white_mps2_[c] * noise_.normal();
    if (is_bridged(out, c)) noisy += config_.bridged_mps2[c] * noise_.normal();
    const double step = config_.step_mps2[c];
    out.accel_mps2[c] = step > 0.0 ? step * std::round(noisy / step) : noisy;
  }
  // Its frame stands level on its springs, and nothing is coupled to it.
  const auto& a = out.accel_mps2;
  out.extra_mps2 = {static_cast<float>(a[0] + 0.5 * (a[1] - a[2])), 0.0F};
  return out;
}

void Surrogate::restart() noexcept {
  count_ = 0;
  motion_ = {};
  piston_m_ = 0.0;
  filter_ = filter_of(config_, kFine);
}

std::optional<Sample> Surrogate::next(const Sample& sample) {
  if (!is_number(sample) || (count_ > 0 && sample.tick != held_.back().tick + 1)) restart();
  if (!is_number(sample)) return sample;
  std::rotate(held_.begin(), held_.begin() + 1, held_.end());
  held_.back() = sample;
  if (++count_ < kTaps) return std::nullopt;
  const double fine_s = 1.0 / (kFine * config_.sample_rate_hz);
  std::array<double, 2> last = between(0);
  std::array<double, kChannels> filtered{};
  for (int i = 1; i <= kFine; ++i) {
    const std::array<double, 2> now = between(i);
    const double from = last[0] + last[1];
    const double to = now[0] + now[1];
    for (int p = 0; p < parts_; ++p)
      step(from + (to - from) * p / parts_, from + (to - from) * (p + 1) / parts_, fine_s / parts_);
    const std::array<double, kChannels> accel{frame_mps2(motion_), now[0], now[1]};
    filtered = config_.low_pass_hz > 0.0 ? filter_.update(accel) : accel;
    last = now;
  }
  return seen(filtered);
}

}  // namespace dampline::effect
