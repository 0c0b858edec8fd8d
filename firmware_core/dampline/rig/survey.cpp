// SPDX-License-Identifier: MIT
#include "dampline/rig/survey.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dampline/rig/columns.hpp"
#include "dampline/rig/motion.hpp"

namespace dampline::rig {
namespace {

constexpr std::int64_t kBlocksWanted = 80;
/// Corners as fractions of the rate, within the test function's limits.
constexpr double kFastest = 6.5;
constexpr double kFastestPrediction = 12.0;
constexpr double kSlowest = 1000.0;
constexpr double kVelocityErrorShare = 0.01;

/// Samples between the two ends of a difference.
constexpr std::size_t samples_of(std::size_t span) noexcept { return std::size_t{1} << span; }

}  // namespace

const Sample& Survey::ago(std::size_t samples) const noexcept {
  return ring_[(next_ + kRing - 1 - samples) % kRing];
}

void Survey::update(const Sample& sample) noexcept {
  if (!is_finite(sample, velocity_measured_)) {
    run_ = 0;
    return;
  }
  if (run_ > 0 && sample.tick != ago(0).tick + 1) run_ = 0;
  ring_[next_] = sample;
  next_ = (next_ + 1) % kRing;
  run_ = std::min(run_ + 1, kRing);
  ++samples_;
  const double delta = sample.deflection_m - mean_m_;
  mean_m_ += delta / static_cast<double>(samples_);
  squares_m2_ += delta * (sample.deflection_m - mean_m_);
  if (run_ == kRing) take_differences();
}

void Survey::take_differences() noexcept {
  const double step = std::abs(ago(0).deflection_m - ago(1).deflection_m);
  if (step > 0.0 && (resolution_m_ == 0.0 || step < resolution_m_)) resolution_m_ = step;
  const auto about = [this](int j) -> const Sample& {
    return ago(static_cast<std::size_t>(j + 4));
  };
  const auto deflection_m = [&](int j) { return about(j).deflection_m; };
  const auto velocity_mps = [&](int j) { return about(j).velocity_mps; };
  deflection_fourth_m_.add(std::abs(fourth_difference(deflection_m)));
  deflection_eighth_m_.add(std::abs(eighth_difference(deflection_m)));
  ++velocities_;
  if (velocity_measured_) {
    velocity_fourth_mps_.add(std::abs(fourth_difference(velocity_mps)));
    return take_speed(0, ago(0).velocity_mps);
  }
  for (std::size_t i = 0; i < kSpans; ++i)
    take_speed(i, (ago(0).deflection_m - ago(samples_of(i)).deflection_m) * rate_hz_ /
                      static_cast<double>(samples_of(i)));
}

void Survey::take_speed(std::size_t span, double velocity_mps) noexcept {
  speed_mps_[span].add(std::abs(velocity_mps));
  velocity_squares_[span] += velocity_mps * velocity_mps;
}

double Survey::mean_square_mps2(std::size_t span) const noexcept {
  return velocities_ == 0 ? 0.0 : velocity_squares_[span] / static_cast<double>(velocities_);
}

/// The longest span whose differences have lost little of the velocity that shorter ones show
/// above their noise.
std::size_t Survey::longest_faithful_span() const noexcept {
  constexpr double kKept = 0.9;  // of the mean square
  if (velocity_measured_) return 0;
  double most = 0.0;
  std::size_t out = kSpans - 1;
  for (std::size_t i = 0; i < kSpans; ++i) {
    const double signal = signal_mps2(i);
    if (!(signal > 0.5 * mean_square_mps2(i))) continue;
    if (signal < kKept * most) break;
    most = std::max(most, signal);
    out = i;
  }
  return out;
}

double Survey::deflection_noise_m() const noexcept {
  return std::max(resolution_m_ / std::sqrt(12.0), white_sigma(deflection_fourth_m_.quantile(0.5),
                                                               deflection_eighth_m_.quantile(0.5)));
}

double Survey::velocity_rms_mps() const noexcept {
  return std::sqrt(mean_square_mps2(longest_faithful_span()));
}

double Survey::motion_frequency_hz() const noexcept {
  if (!(squares_m2_ > 0.0)) return 0.0;
  const double deflection_rms = std::sqrt(squares_m2_ / static_cast<double>(samples_));
  return velocity_rms_mps() / deflection_rms / (2.0 * std::numbers::pi);
}

double Survey::derivative_error_mps(int half_width) const noexcept {
  return DerivativeWindow{half_width, 1.0 / rate_hz_}.noise_gain() * deflection_noise_m();
}

/// Mean square of the velocity that differences over a span show, less that of their noise.
double Survey::signal_mps2(std::size_t span) const noexcept {
  const double noise = deflection_noise_m() * rate_hz_ / static_cast<double>(samples_of(span));
  return mean_square_mps2(span) - 2.0 * noise * noise;
}

/// Where the difference of the neighbours on either side loses velocity and noise permits more.
/// sinc^2: over two and four samples three and fifteen parts are lost of what is lost over one,
/// which shows the whole less one part. A motion with corners loses in proportion to the span, and
/// sixth-order differences would ring there.
bool Survey::wants_sharp_velocity() const noexcept {
  constexpr double kLost = 0.002;
  constexpr double kSmooth = 3.75;  // times the loss over two samples; sinc: 5, corners: 2.5
  if (velocity_measured_) return false;
  const double one = signal_mps2(0);
  const double two = one - signal_mps2(1);
  const double four = one - signal_mps2(2);
  return two > 0.75 * kLost * one && four > kSmooth * two &&
         DerivativeWindow::sharp(1.0 / rate_hz_).noise_gain() * deflection_noise_m() <
             kVelocityErrorShare * velocity_rms_mps();
}

int Survey::choose_half_width(const Config& config) const noexcept {
  const int widest = std::clamp(half_support_samples(config) / 4, 1, kMaxVelocityHalfWidth);
  int half_width = 1;
  while (half_width < widest &&
         derivative_error_mps(half_width) > kVelocityErrorShare * velocity_rms_mps())
    ++half_width;
  return half_width;
}

double Survey::velocity_error_mps(const Config& config) const noexcept {
  if (velocity_measured_) return sigma_of_fourth(velocity_fourth_mps_.quantile(0.5));
  if (config.velocity_sharp)
    return DerivativeWindow::sharp(1.0 / rate_hz_).noise_gain() * deflection_noise_m();
  return derivative_error_mps(config.velocity_half_width);
}

double Survey::quiet_corner_hz(double highest_hz, double lowest_hz) const noexcept {
  constexpr double kNoiseShare = 1e-3;
  // v_rms^2 <= x_rms a_rms, so this acceleration is a lower bound.
  const double accel = 2.0 * std::numbers::pi * motion_frequency_hz() * velocity_rms_mps();
  double corner_hz = highest_hz;
  while (corner_hz > lowest_hz) {
    const TestFunction psi{half_support_samples(corner_hz, rate_hz_), 1.0 / rate_hz_};
    const double noise = psi.second_noise_gain() * deflection_noise_m();
    if (noise * noise < kNoiseShare * accel * accel) break;
    corner_hz /= std::numbers::sqrt2;
  }
  return std::max(corner_hz, lowest_hz);
}

double Survey::choose_corner_hz(const Terms& terms) const noexcept {
  const double motion_hz = 4.0 * motion_frequency_hz();
  const double highest_hz = std::min(std::max(rate_hz_ / 50.0, motion_hz), rate_hz_ / kFastest);
  if (!terms.inertia) return highest_hz;
  const double lowest_hz = std::min(std::max(rate_hz_ / kSlowest, motion_hz), highest_hz);
  return quiet_corner_hz(highest_hz, lowest_hz);
}

Result<Config> Survey::suggest(const Terms& terms, double corner_hz) const noexcept {
  const double top = speed_mps_[longest_faithful_span()].quantile(0.99);
  if (!(top > 0.0) || !(squares_m2_ > 0.0)) return Errc::kNotReady;
  Config out;
  out.sample_rate_hz = rate_hz_;
  out.velocity_measured = velocity_measured_;
  out.corner_hz = corner_hz > 0.0 ? corner_hz : choose_corner_hz(terms);
  out.prediction_corner_hz =
      std::max(out.corner_hz, quiet_corner_hz(rate_hz_ / kFastestPrediction, rate_hz_ / kSlowest));
  out.velocity_sharp = wants_sharp_velocity();
  out.velocity_half_width = out.velocity_sharp ? 3 : choose_half_width(out);
  const double error = velocity_error_mps(out);
  out.sign_width_mps = std::max(1.2533 * error, 1e-4 * velocity_rms_mps());
  out.still_mps = std::max(3.0 * error, 0.01 * velocity_rms_mps());
  for (std::size_t i = 0; i < kCurveSegments; ++i)
    out.curve_nodes_mps[i] = top * static_cast<double>(i + 1) / static_cast<double>(kCurveSegments);
  const auto length = static_cast<std::int64_t>(samples_);
  const std::int64_t half = half_support_samples(out);
  const std::int64_t shortest = 2 * (2 * half + 1);
  out.block_samples = std::max(length / kBlocksWanted, shortest);
  return check(out);
}

}  // namespace dampline::rig
