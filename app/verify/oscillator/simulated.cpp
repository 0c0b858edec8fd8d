// SPDX-License-Identifier: MIT
#include "app/verify/oscillator/simulated.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dampline/motion/butterworth.hpp"
#include "sim_hw/noise.hpp"

namespace dampline::sim {
namespace {

constexpr int kBisections = 40;

double at(const BaseMotion& base, double u) noexcept {
  return (1.0 - u) * (1.0 - 2.0 * u) * base.start_mps2 + 4.0 * u * (1.0 - u) * base.middle_mps2 +
         u * (2.0 * u - 1.0) * base.end_mps2;
}

/// The place in (from, 1] where `holds` ends, given that it holds at `from` and not at 1.
template <class Predicate>
double last_place(double from, const Predicate& holds) noexcept {
  double low = from;
  double high = 1.0;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    (holds(middle) ? low : high) = middle;
  }
  return high;
}

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

void Oscillator::set_motion(double deflection_m, double velocity_mps) noexcept {
  state_ = {deflection_m, velocity_mps};
  direction_ = velocity_mps < 0.0 ? -1 : 1;
}

double Oscillator::accel(const State& at, double base_mps2) const noexcept {
  const double square = at.z * at.z;
  const double friction =
      direction_ * (config_.coulomb_mps2 + config_.coulomb_slope_ps2 * std::abs(at.z));
  return -base_mps2 - (config_.viscous_ps + config_.quadratic_viscous_pm2s * square) * at.v -
         (config_.stiffness_ps2 + config_.cubic_stiffness_pm2s2 * square) * at.z - friction;
}

Oscillator::State Oscillator::moved(const BaseMotion& base, double from, double to,
                                    double step_s) const noexcept {
  const double h = (to - from) * step_s;
  const double start = at(base, from);
  const double middle = at(base, 0.5 * (from + to));
  const double end = at(base, to);
  const auto ahead = [&](double v, double a, double length) {
    return State{state_.z + length * v, state_.v + length * a};
  };
  const double a1 = accel(state_, start);
  const State s2 = ahead(state_.v, a1, 0.5 * h);
  const double a2 = accel(s2, middle);
  const State s3 = ahead(s2.v, a2, 0.5 * h);
  const double a3 = accel(s3, middle);
  const State s4 = ahead(s3.v, a3, h);
  const double a4 = accel(s4, end);
  return {state_.z + h / 6.0 * (state_.v + 2.0 * (s2.v + s3.v) + s4.v),
          state_.v + h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4)};
}

int Oscillator::start_direction(double base_mps2) const noexcept {
  const double z = state_.z;
  const double push =
      -base_mps2 - (config_.stiffness_ps2 + config_.cubic_stiffness_pm2s2 * z * z) * z;
  const double friction = config_.coulomb_mps2 + config_.coulomb_slope_ps2 * std::abs(z);
  if (std::abs(push) <= friction) return 0;
  return push > 0.0 ? 1 : -1;
}

double Oscillator::slide(const BaseMotion& base, double from, double step_s) noexcept {
  const State end = moved(base, from, 1.0, step_s);
  const bool reversed = end.v * direction_ < 0.0;
  if (!reversed || !has_friction()) {
    state_ = end;
    return 1.0;
  }
  const double stop = last_place(
      from, [&](double u) { return moved(base, from, u, step_s).v * direction_ >= 0.0; });
  state_ = {moved(base, from, stop, step_s).z, 0.0};
  const int next = start_direction(at(base, stop));
  direction_ = next;
  return stop;
}

double Oscillator::stick(const BaseMotion& base, double from) noexcept {
  if (start_direction(at(base, 1.0)) == 0) return 1.0;
  const double loose =
      last_place(from, [&](double u) { return start_direction(at(base, u)) == 0; });
  direction_ = start_direction(at(base, loose));
  return loose;
}

void Oscillator::step(const BaseMotion& base, double step_s) noexcept {
  for (double place = 0.0; place < 1.0;) {
    place = sticks() ? stick(base, place) : slide(base, place, step_s);
  }
}

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
