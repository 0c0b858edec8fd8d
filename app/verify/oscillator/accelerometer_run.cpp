// SPDX-License-Identifier: MIT
#include "app/verify/oscillator/accelerometer_run.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim_hw/butterworth.hpp"
#include "sim_hw/noise.hpp"

namespace dampline::sim {
namespace {

constexpr int kStepsPerSample = 32;
constexpr double kSettleS = 8.0;

/// White noise in a band at twice the rate of the integration, of unit rms.
class BandNoise {
 public:
  BandNoise(double lowest_hz, double highest_hz, double rate_hz, std::uint64_t seed)
      : low_pass_{highest_hz, rate_hz},
        random_{seed, Stream::kTrack},
        // One-sided density of unit white noise: 2 / rate. A fourth-order Butterworth low pass
        // passes 1.0262 times its corner; a second-order high pass loses 1.1107 times its own.
        gain_{1.0 / std::sqrt(2.0 / rate_hz * (1.0262 * highest_hz - 1.1107 * lowest_hz))} {
    const double k = std::tan(std::numbers::pi * lowest_hz / rate_hz);
    const double norm = 1.0 / (1.0 + std::numbers::sqrt2 * k + k * k);
    b_ = norm;
    a1_ = 2.0 * (k * k - 1.0) * norm;
    a2_ = (1.0 - std::numbers::sqrt2 * k + k * k) * norm;
  }
  [[nodiscard]] double next() noexcept {
    const double x = low_pass_.update({gain_ * random_.normal()})[0];
    const double y = b_ * x + first_;
    first_ = -2.0 * b_ * x - a1_ * y + second_;
    second_ = b_ * x - a2_ * y;
    return y;
  }

 private:
  ButterworthLowPass<1> low_pass_;
  Random random_;
  double gain_;
  double b_{0.0};
  double a1_{0.0};
  double a2_{0.0};
  double first_{0.0};
  double second_{0.0};
};

class Sensor {
 public:
  Sensor(const AccelerometerRunConfig& config, double bias_mps2) noexcept
      : lsb_mps2_{config.bits > 0 ? std::ldexp(config.full_scale_mps2, 1 - config.bits) : 0.0},
        noise_mps2_{config.noise_lsb * lsb_mps2_},
        bias_mps2_{bias_mps2},
        lowest_{-std::ldexp(1.0, config.bits - 1)} {}
  [[nodiscard]] double read(double accel_mps2, Random& random) const noexcept {
    const double seen = accel_mps2 + bias_mps2_ + noise_mps2_ * random.normal();
    if (lsb_mps2_ == 0.0) return seen;
    return lsb_mps2_ * std::clamp(std::round(seen / lsb_mps2_), lowest_, -lowest_ - 1.0);
  }

 private:
  double lsb_mps2_;
  double noise_mps2_;
  double bias_mps2_;
  double lowest_;
};

}  // namespace

AccelerometerRun run_accelerometers(const AccelerometerRunConfig& config) {
  const double rate_hz = kStepsPerSample * config.sample_rate_hz;
  BandNoise noise{config.lowest_hz, config.highest_hz, 2.0 * rate_hz, config.seed};
  Oscillator oscillator{config.oscillator};
  ButterworthLowPass<2> anti_alias{
      config.anti_alias_hz > 0.0 ? config.anti_alias_hz : 0.25 * rate_hz, rate_hz};
  const Sensor mass_sensor{config, config.mass_bias_mps2};
  const Sensor base_sensor{config, config.base_bias_mps2};
  Random sensor_noise{config.seed, Stream::kSensors};
  const auto settle = static_cast<long>(kSettleS * config.sample_rate_hz);
  const auto samples = static_cast<long>(config.duration_s * config.sample_rate_hz);
  AccelerometerRun run;
  double square = 0.0;
  long stuck = 0;
  double base = 0.0;
  for (long n = -settle; n < samples; ++n) {
    ButterworthLowPass<2>::Values seen{};
    for (int i = 0; i < kStepsPerSample; ++i) {
      const double middle = config.base_rms_mps2 * noise.next();
      const double end = config.base_rms_mps2 * noise.next();
      oscillator.step({base, middle, end}, 1.0 / rate_hz);
      base = end;
      seen = {oscillator.mass_accel_mps2(base), base};
      if (config.anti_alias_hz > 0.0) seen = anti_alias.update(seen);
    }
    if (n < 0) continue;
    const double mass = oscillator.mass_accel_mps2(base);
    square += mass * mass;
    stuck += oscillator.sticks() ? 1 : 0;
    run.mass_mps2.push_back(mass_sensor.read(seen[0], sensor_noise));
    run.base_mps2.push_back(base_sensor.read(seen[1], sensor_noise));
    run.deflection_m.push_back(oscillator.deflection_m());
    run.velocity_mps.push_back(oscillator.velocity_mps());
  }
  run.mass_rms_mps2 = std::sqrt(square / static_cast<double>(samples));
  run.stick_share = static_cast<double>(stuck) / static_cast<double>(samples);
  return run;
}

double base_rms_for(AccelerometerRunConfig config, double mass_rms_mps2) {
  for (int i = 0; i < 4; ++i) {
    config.base_rms_mps2 *= mass_rms_mps2 / run_accelerometers(config).mass_rms_mps2;
  }
  return config.base_rms_mps2;
}

}  // namespace dampline::sim
