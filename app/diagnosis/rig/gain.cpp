// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/gain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "app/diagnosis/rig/regression.hpp"
#include "app/error.hpp"

namespace dampline::app::rig {
namespace {

constexpr double kStretchOfPeriod = 0.125;
constexpr std::size_t kGainBlocks = 20;
constexpr Eigen::Index kFewestPairs = 200;
constexpr double kLeastError = 0.01;
constexpr double kGainSignificant = 4.0;
constexpr double kOtherUnit = 0.5;  // off by more: no sensitivity is so wrong
constexpr double kLeastRelated = 0.5;

/// Sums of a straight line through pairs.
struct Sums {
  double n{0.0}, x{0.0}, y{0.0}, xx{0.0}, xy{0.0}, yy{0.0};
  void add(double a, double b) {
    n += 1.0;
    x += a;
    y += b;
    xx += a * a;
    xy += a * b;
    yy += b * b;
  }
  [[nodiscard]] Sums with(const Sums& o) const {
    return {n + o.n, x + o.x, y + o.y, xx + o.xx, xy + o.xy, yy + o.yy};
  }
  [[nodiscard]] Sums without(const Sums& o) const {
    return {n - o.n, x - o.x, y - o.y, xx - o.xx, xy - o.xy, yy - o.yy};
  }
  [[nodiscard]] double variance_x() const { return xx - x * x / n; }
  [[nodiscard]] double variance_y() const { return yy - y * y / n; }
  [[nodiscard]] double covariance() const { return xy - x * y / n; }
  [[nodiscard]] double gain(double noise) const {
    return covariance() / (variance_x() - n * noise);
  }
};

Eigen::Index stretch_of(const Series& s) {
  const double x = std::sqrt((s.deflection_m.array() - s.deflection_m.mean()).square().mean());
  double squares = 0.0;
  for (Eigen::Index i = 1; i < s.size(); ++i) {
    const double step = s.deflection_m[i] - s.deflection_m[i - 1];
    squares += step * step / static_cast<double>(s.size());
  }
  const double period = 2.0 * std::numbers::pi * x * s.interval_s / std::sqrt(squares);
  const double samples = kStretchOfPeriod * period / s.interval_s;
  return std::clamp<Eigen::Index>(static_cast<Eigen::Index>(samples), 2, s.size() / 8);
}

bool is_whole(const Series& s, Eigen::Index from, Eigen::Index to) {
  return s.time_s[to] - s.time_s[from] < (static_cast<double>(to - from) + 0.5) * s.interval_s;
}

/// Trapezoids with the ends' correction: the rate's derivative there.
double velocity_integral(const Series& s, const std::vector<double>& sums, Eigen::Index from,
                         Eigen::Index to) {
  const Eigen::VectorXd& v = s.velocity_mps;
  const double inside = sums[static_cast<std::size_t>(to + 1)] -
                        sums[static_cast<std::size_t>(from)] - 0.5 * (v[from] + v[to]);
  const double ends = 0.5 * (v[to + 1] - v[to - 1] - v[from + 1] + v[from - 1]);
  return s.interval_s * (inside - ends / 12.0);
}

double accel_integral(const Series& s, Eigen::Index at, Eigen::Index half) {
  const Eigen::VectorXd& a = s.accel_mps2;
  double sum = 0.0;
  for (Eigen::Index j = 1 - half; j < half; ++j) {
    const double curved = (a[at + j + 1] - 2.0 * a[at + j] + a[at + j - 1]) / 12.0;
    sum += static_cast<double>(half - std::abs(j)) * (a[at + j] + curved);
  }
  return s.interval_s * s.interval_s * sum;
}

Gain line_through(const std::vector<Sums>& blocks, double noise) {
  Sums all;
  for (const Sums& b : blocks) all = all.with(b);
  Gain out;
  if (all.n < static_cast<double>(kFewestPairs) || !(all.variance_x() > 2.0 * all.n * noise) ||
      !(all.variance_y() > 0.0))
    return out;
  out.known = true;
  out.gain = all.gain(noise);
  out.related = all.covariance() * all.covariance() / (all.variance_x() * all.variance_y());
  const auto left = [&](double gain) {
    return (all.variance_y() - 2.0 * gain * all.covariance() + gain * gain * all.variance_x()) /
           all.variance_y();
  };
  out.nmse_before = left(1.0);
  out.nmse_after = left(out.gain);
  std::vector<double> gains;
  for (const Sums& b : blocks)
    if (b.n > 0.0) gains.push_back(all.without(b).gain(noise));
  out.std = jackknife_std(gains);
  return out;
}

std::vector<Sums> empty_blocks() { return std::vector<Sums>(kGainBlocks); }
Sums& block_of(std::vector<Sums>& blocks, Eigen::Index at, Eigen::Index size) {
  return blocks[static_cast<std::size_t>(at) * kGainBlocks / static_cast<std::size_t>(size)];
}

void check_rate(const Series& series, const Gain& gain, const char* column, const char* what) {
  if (!gain.known) return;
  if (gain.related < kLeastRelated)
    throw RunError{
        fmt::format("{}: {}: found no relation to deflection_m (correlation {:.2f}), expected its "
                    "{}; leave the "
                    "column out, or name another in [input.columns]",
                    series.record, column, std::sqrt(gain.related), what)};
  if (std::abs(gain.gain - 1.0) > kOtherUnit)
    throw RunError{fmt::format(
        "{}: {}: found {:.4g} times the {} of deflection_m, expected 1: another unit or sign of "
        "one "
        "of them; write into the configuration, beside a scale that is there:\n[input.scale]\n{} = "
        "{:.4g}",
        series.record, column, gain.gain, what, column, 1.0 / gain.gain)};
}

void judge(const Gain& gain, const std::string& record, const char* column, Explanation& out) {
  const double error = std::abs(gain.gain - 1.0);
  if (!gain.known || error < kLeastError || error < kGainSignificant * gain.std) return;
  const auto named = [](const Step& s) { return s.effect == "gain_error"; };
  if (std::none_of(out.steps.begin(), out.steps.end(), named)) {
    Step step;
    step.effect = "gain_error";
    step.of = column;
    step.terms = out.final.terms;
    step.held_out_before = gain.nmse_before;
    step.held_out_after = gain.nmse_after;
    step.gain = 1.0 - gain.nmse_after / gain.nmse_before;
    step.block_t = error / gain.std;
    step.parameters = {
        {fmt::format("gain_error_{}", column), 100.0 * (gain.gain - 1.0), 100.0 * gain.std, "%"}};
    out.steps.push_back(step);
  }
  out.notes.push_back(
      fmt::format("{}: {} is {:.4f} ± {:.1g} of what deflection_m says: the sensitivity of either "
                  "may be wrong.",
                  record, column, gain.gain, gain.std));
}

Gain velocity_gain(const Series& series) {
  if (!series.config.velocity_measured || series.size() < kFewestPairs) return {};
  const Eigen::Index half = stretch_of(series);
  std::vector<double> sums(1, 0.0);
  for (const double v : series.velocity_mps) sums.push_back(sums.back() + v);
  std::vector<Sums> blocks = empty_blocks();
  for (Eigen::Index i = half + 1; i + half + 1 < series.size(); ++i) {
    if (!is_whole(series, i - half - 1, i + half + 1)) continue;
    block_of(blocks, i, series.size())
        .add(series.deflection_m[i + half] - series.deflection_m[i - half],
             velocity_integral(series, sums, i - half, i + half));
  }
  return line_through(blocks, 2.0 * series.noise_m * series.noise_m);
}

Gain accel_gain(const Series& series) {
  if (series.accel_mps2.size() != series.size() || series.size() < kFewestPairs) return {};
  const Eigen::Index half = stretch_of(series);
  const Eigen::Index stride = std::max<Eigen::Index>(1, half / 8);
  std::vector<Sums> blocks = empty_blocks();
  for (Eigen::Index i = half + 1; i + half + 1 < series.size(); i += stride) {
    if (!is_whole(series, i - half - 1, i + half + 1)) continue;
    const Eigen::VectorXd& x = series.deflection_m;
    const double integral = accel_integral(series, i, half);
    if (!std::isfinite(integral)) continue;
    block_of(blocks, i, series.size()).add(x[i + half] - 2.0 * x[i] + x[i - half], integral);
  }
  return line_through(blocks, 6.0 * series.noise_m * series.noise_m);
}

}  // namespace

Gains checked_gains(const Series& series) {
  const Gains out{velocity_gain(series), accel_gain(series)};
  check_rate(series, out.velocity, "velocity_mps", "rate");
  check_rate(series, out.accel, "accel_mps2", "second derivative");
  return out;
}

void judge_gains(const std::vector<Gains>& gains, Explanation& out) {
  bool seen = false;
  for (std::size_t i = 0; i < gains.size(); ++i) {
    seen = seen || gains[i].velocity.known || gains[i].accel.known;
    judge(gains[i].velocity, out.records[i], "velocity_mps", out);
    judge(gains[i].accel, out.records[i], "accel_mps2", out);
  }
  if (!seen)
    out.notes.emplace_back(
        "gain_error cannot be seen: a wrong sensitivity of force or deflection is a factor of "
        "every "
        "parameter. A measured velocity or acceleration beside the deflection would show one.");
}

}  // namespace dampline::app::rig
