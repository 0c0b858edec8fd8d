// SPDX-License-Identifier: MIT
#include "app/diagnosis/truck/other_truck.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "app/diagnosis/truck/points.hpp"
#include "dampline/effect/modes.hpp"

namespace dampline::app {
namespace {

using Series = std::vector<float>;

constexpr double kLongestS = 3600.0;
constexpr double kShortestDelayS = 0.2;  // below, what one model leaves follows its own motion
constexpr double kLongestDelayS = 2.0;   // pivots 9 m apart at 16 km/h
constexpr double kLeastCorrelation = 0.1;
constexpr double kLeastShare = 0.05;  // of the mass that the body has at the other truck
constexpr double kOneSided = 0.5;     // joints of the rail show on both sides
constexpr int kSteps = 4;
constexpr std::size_t kParts = 20;
constexpr double kLinearised = 0.08;  // of the mass, by friction's equivalent damping

/// Less its mean over a second, as what is left is.
Series without_mean(const Series& x, double rate_hz) {
  const std::vector<double> exact = mean_weights(rate_hz);
  const Series weights{exact.begin(), exact.end()};
  Series out(x.size(), 0.0F);
  const std::size_t reach = weights.size() / 2;
  for (std::size_t i = reach; i + reach < x.size(); ++i) {
    float mean = 0.0F;
    for (std::size_t w = 0; w < weights.size(); ++w) mean += weights[w] * x[i - reach + w];
    out[i] = x[i] - mean;
  }
  return out;
}

/// x(t - delay), by the cubic through four neighbours; 0 beyond the ends.
Series delayed(const Series& x, double delay_ticks) {
  Series out(x.size(), 0.0F);
  const double whole = std::floor(-delay_ticks);
  const auto u = static_cast<float>(-delay_ticks - whole);
  const auto shift = static_cast<std::ptrdiff_t>(whole);
  const std::array<float, 4> weight{
      -u * (u - 1.0F) * (u - 2.0F) / 6.0F, (u + 1.0F) * (u - 1.0F) * (u - 2.0F) / 2.0F,
      -(u + 1.0F) * u * (u - 2.0F) / 2.0F, (u + 1.0F) * u * (u - 1.0F) / 6.0F};
  const auto size = static_cast<std::ptrdiff_t>(x.size());
  const std::ptrdiff_t first = std::max<std::ptrdiff_t>(0, 1 - shift);
  const std::ptrdiff_t last = std::min(size, size - shift - 2);
  for (std::ptrdiff_t i = first; i < last; ++i) {
    const float* at = x.data() + (i + shift - 1);
    out[static_cast<std::size_t>(i)] =
        weight[0] * at[0] + weight[1] * at[1] + weight[2] * at[2] + weight[3] * at[3];
  }
  return out;
}

/// The other frame's acceleration; see FrameLaw.
Series other_frame(const Series& frame_mps2, const FrameLaw& law, double share, double delay_ticks,
                   double rate_hz) {
  const double omega = std::sqrt(2.0 * law.stiffness_npm / law.mass_kg);
  const double damping_nspm =
      law.coulomb_n * std::sqrt(2.0 / std::numbers::pi) / law.velocity_rms_mps;
  const double ratio = damping_nspm / (law.mass_kg * omega);
  const Series alike = delayed(frame_mps2, delay_ticks);
  Series out = alike;
  for (int round = 0; round < 3; ++round) {  // the share's third power is under a hundredth
    const Series back = delayed(out, delay_ticks);
    effect::Resonator answer{omega / (2.0 * std::numbers::pi), ratio, 1.0 / rate_hz};
    for (std::size_t i = 0; i < out.size(); ++i) {
      answer.update(double{frame_mps2[i]} - double{back[i]});
      out[i] = alike[i] - static_cast<float>(share * answer.acceleration());
    }
  }
  return out;
}

double dot(const Series& a, const Series& b, std::ptrdiff_t lag) {
  const auto size = static_cast<std::ptrdiff_t>(a.size());
  const std::ptrdiff_t first = std::max<std::ptrdiff_t>(0, lag);
  const std::ptrdiff_t last = std::min(size, size + lag);
  constexpr std::ptrdiff_t kRun = 4096;  // floats add up exactly enough
  double sum = 0.0;
  for (std::ptrdiff_t from = first; from < last; from += kRun) {
    float part = 0.0F;
    const std::ptrdiff_t to = std::min(last, from + kRun);
    for (std::ptrdiff_t i = from; i < to; ++i)
      part += a[static_cast<std::size_t>(i)] * b[static_cast<std::size_t>(i - lag)];
    sum += part;
  }
  return sum;
}

/// The delay by which what is left follows the frame's motion, in ticks; 0: by none.
double delay_in(const Series& left, const Series& frame, double rate_hz) {
  const double size = std::sqrt(dot(left, left, 0) * dot(frame, frame, 0));
  if (!(size > 0.0)) return 0.0;
  const auto shortest = std::lround(kShortestDelayS * rate_hz);
  const auto longest = std::lround(kLongestDelayS * rate_hz);
  std::vector<double> found(static_cast<std::size_t>(2 * longest + 1), 0.0);
  const auto at = [&](std::ptrdiff_t lag) -> double& {
    return found[static_cast<std::size_t>(lag + longest)];
  };
  for (std::ptrdiff_t lag = shortest; lag <= longest; ++lag)
    for (const std::ptrdiff_t one : {lag, -lag}) at(one) = dot(left, frame, one) / size;
  const auto best = std::max_element(found.begin(), found.end()) - found.begin() - longest;
  const auto distance = std::abs(best);
  if (distance <= shortest || distance >= longest) return 0.0;  // a slope, no summit
  double opposite = 0.0;
  for (std::ptrdiff_t n = -2; n <= 2; ++n)
    if (std::abs(n - best) <= longest) opposite = std::max(opposite, std::abs(at(n - best)));
  const double peak = at(best);
  if (peak < kLeastCorrelation || opposite > kOneSided * peak) return 0.0;
  const double bend = at(best - 1) - 2.0 * peak + at(best + 1);
  const double top = 0.5 * (at(best - 1) - at(best + 1)) / bend;
  return static_cast<double>(best) + (std::abs(top) < 1.0 ? top : 0.0);
}

}  // namespace

Sample OtherTruck::beside(Sample sample) const noexcept {
  const std::int64_t at = sample.tick - first_tick;
  if (at >= 0 && at < static_cast<std::int64_t>(accel_mps2.size()))
    sample.extra_mps2[static_cast<std::size_t>(Extra::kFarFrame)] =
        accel_mps2[static_cast<std::size_t>(at)];
  return sample;
}

void OtherTruckSearch::clear() { *this = OtherTruckSearch{rate_hz_}; }

void OtherTruckSearch::take(const Sample& sample) {
  if (!first_tick_) first_tick_ = sample.tick;
  const std::int64_t at = sample.tick - *first_tick_;
  too_long_ = too_long_ || static_cast<double>(at) > kLongestS * rate_hz_;
  if (too_long_ || at < 0) return;
  frame_mps2_.resize(static_cast<std::size_t>(at) + 1, 0.0F);
  const double accel_mps2 = sample.accel_mps2[0];
  frame_mps2_.back() = std::isfinite(accel_mps2) ? static_cast<float>(accel_mps2) : 0.0F;
}

void OtherTruckSearch::add(const EvidencePoint& point) {
  const auto at = static_cast<std::size_t>(std::lround(point.time_s * rate_hz_));
  if (too_long_ || at >= frame_mps2_.size()) return;
  for (Series* series : {&left_n_, &deflection_m_, &velocity_mps_, &final_n_})
    series->resize(at + 1, 0.0F);
  left_n_.back() = static_cast<float>(point.measured_n - point.final_n);
  deflection_m_.back() = static_cast<float>(point.deflection_m);
  velocity_mps_.back() = static_cast<float>(point.velocity_mps);
  final_n_.back() = static_cast<float>(point.final_n);
}

namespace {

/// What is left, as other frame, its shift, and what the law's own parameters would take of it.
struct Regression {
  static constexpr int kColumns = 5;
  using Matrix = Eigen::Matrix<double, kColumns, kColumns>;
  using Vector = Eigen::Matrix<double, kColumns, 1>;
  std::array<Matrix, kParts> gram{};
  std::array<Vector, kParts> moment{};
  Regression() {
    gram.fill(Matrix::Zero());
    moment.fill(Vector::Zero());
  }
  void add(std::size_t part, const Vector& row, double target) {
    gram[part] += row * row.transpose();
    moment[part] += row * target;
  }
  /// Of all parts but one.
  [[nodiscard]] Vector solve(std::size_t without = kParts) const {
    Matrix a = Matrix::Zero();
    Vector b = Vector::Zero();
    for (std::size_t p = 0; p < kParts; ++p) {
      if (p == without) continue;
      a += gram[p];
      b += moment[p];
    }
    const Vector size = a.diagonal().cwiseSqrt().cwiseMax(std::numeric_limits<double>::min());
    a = size.cwiseInverse().asDiagonal() * a * size.cwiseInverse().asDiagonal();
    return (a.ldlt().solve(b.cwiseQuotient(size))).cwiseQuotient(size);
  }
  /// Of what of() makes of the solution, by leaving out a part at a time.
  template <class Of>
  [[nodiscard]] double std(Of of) const {
    std::array<double, kParts> one{};
    double mean = 0.0;
    for (std::size_t p = 0; p < kParts; ++p) mean += (one[p] = of(solve(p))) / kParts;
    double squares = 0.0;
    for (const double x : one) squares += (x - mean) * (x - mean);
    return std::sqrt(squares * (kParts - 1) / kParts);
  }
};

}  // namespace

std::optional<OtherTruck> OtherTruckSearch::find(const FrameLaw& law) const {
  if (too_long_ || left_n_.empty() ||
      !(law.stiffness_npm > 0.0 && law.coulomb_n > 0.0 && law.velocity_rms_mps > 0.0))
    return std::nullopt;
  Series frame = without_mean(frame_mps2_, rate_hz_);
  Series left = left_n_;
  left.resize(frame.size(), 0.0F);
  double delay_ticks = delay_in(left, frame, rate_hz_);
  if (delay_ticks == 0.0) return std::nullopt;
  const std::size_t count = left_n_.size();
  double share = 0.1;
  OtherTruck out;
  for (int round = 0; round < kSteps; ++round) {
    const Series other = other_frame(frame, law, share, delay_ticks, rate_hz_);
    Regression all;
    for (std::size_t i = 1; i + 1 < count; ++i) {
      if (left_n_[i] == 0.0F) continue;
      const double slope = 0.5 * (double{other[i + 1]} - double{other[i - 1]});
      const double sign = std::tanh(double{velocity_mps_[i]} / (0.1 * law.velocity_rms_mps));
      all.add(i * kParts / count, {other[i], slope, deflection_m_[i], final_n_[i], sign},
              left_n_[i]);
    }
    const auto best = all.solve();
    share = best[0] / law.mass_kg;
    delay_ticks -= std::clamp(best[1] / best[0], -1.0, 1.0);
    if (!(share > 0.0 && share < 0.5)) return std::nullopt;
    const double mass_std = all.std([](const auto& x) { return x[0]; });
    out.mass_kg = {best[0], std::hypot(mass_std, kLinearised * best[0])};
    out.delay_s = {delay_ticks / rate_hz_,
                   all.std([](const auto& x) { return x[1] / x[0]; }) / rate_hz_};
  }
  if (share < kLeastShare) return std::nullopt;
  out.first_tick = *first_tick_;
  out.accel_mps2 = other_frame(frame, law, share, delay_ticks, rate_hz_);
  return out;
}

}  // namespace dampline::app
