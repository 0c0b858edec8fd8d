// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/surrogate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "app/diagnosis/rig/library.hpp"
#include "app/diagnosis/rig/trials.hpp"
#include "app/law/start.hpp"
#include "dampline/numeric/random.hpp"
#include "dampline/rig/motion.hpp"
#include "dampline/rig/survey.hpp"

namespace dampline::app::rig {
namespace {

constexpr double kWhole = 0.02;            // a difference is a whole number of steps within this
constexpr double kMostlyWhole = 0.98;      // of the differences
constexpr double kFewestStepShare = 1e-6;  // of the range: a finer step is how numbers are printed
constexpr std::uint64_t kSeed = 1987;
constexpr std::uint64_t kSensors = 1;  // stream of the seed
constexpr double kMaybeSign = 0.15;    // rms of v: a narrower law may be the sign in truth
constexpr double kRepeats = 0.1;       // of the motion's rms, by which periods may differ
constexpr Eigen::Index kLookedAt = 4000;
constexpr double kFewestPeriods = 3.0;
constexpr double kMedianOfNormal = 0.67449;
constexpr double kOtherWay = 0.05;  // of the deflection's variance: it moves otherwise

double rounded(double value, double step) {
  return step > 0.0 ? step * std::round(value / step) : value;
}

double white_part(double noise, double step) {
  return std::sqrt(std::max(noise * noise - step * step / 12.0, 0.0));
}

bool is_friction(const Regressor& column, const Law& law) {
  return std::any_of(law.friction.begin(), law.friction.end(), [&](const Regressor& c) {
    return c.kind == column.kind && c.a == column.a && column.time == c.time;
  });
}

/// A law no wider than an error of the velocity, or a derivative over corners of the motion, makes
/// it: in truth it may be the sign.
bool is_sign(const Regressor& column, const Law& law) {
  return is_friction(column, law) &&
         (!is_smooth(column, law.scale) || column.a < kMaybeSign * law.scale.velocity_mps);
}

/// RMS of white noise that differences of two samples at a period's distance show; infinite where
/// there is no period.
double unrepeated(const Eigen::VectorXd& values, double period) {
  const auto whole = static_cast<Eigen::Index>(std::ceil(period)) + 2;
  std::vector<double> differences;
  for (Eigen::Index i = 0; i + whole < values.size(); ++i)
    differences.push_back(std::abs(between(values, static_cast<double>(i) + period) - values[i]));
  return median_of(differences) / (kMedianOfNormal * std::numbers::sqrt2);
}

/// The samples after which the motion repeats; 0: it does not.
double period_of(const Eigen::VectorXd& x) {
  const Eigen::Index stride = std::max<Eigen::Index>(1, x.size() / kLookedAt);
  const double variance = (x.array() - x.mean()).square().mean();
  const auto most = static_cast<Eigen::Index>(static_cast<double>(x.size()) / kFewestPeriods);
  const auto off = [&](double period) {
    double sum = 0.0;
    double count = 0.0;
    for (Eigen::Index i = 0; static_cast<double>(i) + period + 2.0 < static_cast<double>(x.size());
         i += stride, ++count) {
      const double d = between(x, static_cast<double>(i) + period) - x[i];
      sum += d * d;
    }
    return sum / (count * 2.0 * variance);
  };
  const auto off_at = [&](Eigen::Index lag) {
    double sum = 0.0;
    double count = 0.0;
    for (Eigen::Index i = 0; i + lag < x.size(); i += stride, ++count)
      sum += (x[i + lag] - x[i]) * (x[i + lag] - x[i]);
    return sum / (count * 2.0 * variance);
  };
  bool apart = false;
  for (Eigen::Index lag = 4; lag < most; ++lag) {
    const double here = off_at(lag);
    apart = apart || here > 0.5;
    if (!apart || here > 4.0 * kRepeats * kRepeats) continue;
    auto best = static_cast<double>(lag);
    for (double step = 1.0; step > 0.01; step *= 0.5)
      for (const double at : {best - step, best + step})
        if (off(at) < off(best)) best = at;
    if (off(best) < kRepeats * kRepeats) return best;
  }
  return 0.0;
}

/// The measured deflection without what is faster than the derivative sees.
Eigen::VectorXd smoothed(const Series& record) {
  const Eigen::Index half = std::max(2, record.config.velocity_half_width);
  const Eigen::VectorXd& x = record.deflection_m;
  Eigen::VectorXd out{x.size()};
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const Eigen::Index reach = std::min({half, i, x.size() - 1 - i});
    double sum = 0.0;
    double weights = 0.0;
    for (Eigen::Index j = -reach; j <= reach; ++j) {
      const double u = static_cast<double>(j) / static_cast<double>(reach + 1);
      const double weight = (1.0 - u * u) * (1.0 - u * u);
      sum += weight * x[i + j];
      weights += weight;
    }
    out[i] = sum / weights;
  }
  return out;
}

/// Sixth-order differences; the three values at either end are 0.
Eigen::VectorXd derivative(const Eigen::VectorXd& x, double interval_s) {
  const core::DerivativeWindow window = core::DerivativeWindow::sharp(interval_s);
  Eigen::VectorXd out = Eigen::VectorXd::Zero(x.size());
  for (Eigen::Index i = 3; i + 3 < x.size(); ++i)
    for (int j = 1; j <= 3; ++j) out[i] += window.weight(j) * (x[i + j] - x[i - j]);
  return out;
}

/// The motion that the surrogate makes, known exactly.
Series true_motion(const Series& record) {
  Series out = record;
  out.deflection_m = smoothed(record);
  if (record.config.velocity_measured) return out;
  out.velocity_mps = derivative(out.deflection_m, record.interval_s);
  return out;
}

Eigen::VectorXd force_of(const Law& law, const Series& motion) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(motion.size());
  for (std::size_t c = 0; c < law.columns.size(); ++c) {
    const Regressor& column = law.columns[c];
    const double theta = law.theta[static_cast<Eigen::Index>(c)];
    if (!is_sign(column, law) && column.kind != Kind::kInertia) {
      out += theta * evaluate(column, motion);
      continue;
    }
    const Eigen::VectorXd values = column.kind == Kind::kInertia
                                       ? derivative(motion.velocity_mps, motion.interval_s)
                                       : Eigen::VectorXd{motion.velocity_mps.array().sign()};
    out += theta * through_mode(values, motion.path, motion.interval_s);
  }
  return out;
}

/// What the estimator would leave, which takes the best of all ways to write sign v.
double left_of(const std::vector<Series>& surrogates, const Law& law) {
  TrialBase base;
  base.ridge = law.ridge;
  for (const Regressor& c : law.columns) {
    if (is_friction(c, law))
      base.friction = law.friction;
    else
      base.columns.push_back(c);
  }
  return best_fit(surrogates, base).held_out_nmse;
}

/// As they are seen: the white part of the force's noise, no more than what periods differ by.
double force_noise(const Series& record, const Eigen::VectorXd& force, double period) {
  const double white = std::min(white_noise(record.force_n), white_noise(record.force_n - force));
  return period > 0.0 ? std::min(white, unrepeated(record.force_n, period)) : white;
}

/// The record once more: the force that a law makes of a known motion, measured.
Series surrogate_of(const Series& record, const Series& truth, const Eigen::VectorXd& force,
                    double force_noise_n, double period, std::uint64_t seed) {
  Random noise{seed, kSensors};
  const double step_m = resolution_of(record.deflection_m);
  const double step_n = resolution_of(record.force_n);
  const double seen_m = period > 0.0
                            ? std::min(record.noise_m, unrepeated(record.deflection_m, period))
                            : record.noise_m;
  const double noise_m = white_part(seen_m, step_m);
  const double noise_n = white_part(force_noise_n, step_n);
  const double noise_mps = record.config.velocity_measured ? white_noise(record.velocity_mps) : 0.0;
  const double shift_m = step_m * (noise.uniform() - 0.5);  // other roundings than the record's
  core::MotionEstimator estimator{record.config};
  std::vector<core::Motion> motions;
  std::vector<double> time_s;
  std::vector<double> left_out;
  std::int64_t tick = 0;
  const Eigen::Index late = estimator.latency_samples();
  for (Eigen::Index i = 0; i < record.size(); ++i) {
    ++tick;
    if (i > 0 && record.time_s[i] - record.time_s[i - 1] > 1.5 * record.interval_s)
      estimator.reset();
    core::Motion motion;
    const core::Sample sample{
        tick, rounded(truth.deflection_m[i] + shift_m + noise_m * noise.normal(), step_m),
        truth.velocity_mps[i] + noise_mps * noise.normal(),
        rounded(force[i] + noise_n * noise.normal(), step_n)};
    if (!estimator.update(sample, motion)) continue;
    motions.push_back(motion);
    time_s.push_back(record.time_s[i - late]);
    left_out.push_back(record.why_left_out(i - late));
  }
  Series surrogate = record;
  surrogate.left_out = vector_of(left_out);
  surrogate.time_s = vector_of(time_s);
  surrogate.set_motion(motions);
  return surrogate;
}

}  // namespace

std::optional<Series> moved_surrogate(const Series& record, const law::Law& law,
                                      double force_noise_n, std::uint64_t seed) {
  const law::Input input{record.force_n, record.interval_s};
  const law::State start =
      law::start_of(law, {record.force_n, record.deflection_m, record.velocity_mps,
                          record.interval_s, record.noise_m});
  law::Course course = law::move(law, input, start);
  if (!course.whole) return std::nullopt;
  const Eigen::VectorXd apart = course.deflection_m - record.deflection_m;
  const double variance = (record.deflection_m.array() - record.deflection_m.mean()).square().sum();
  if (apart.squaredNorm() > kOtherWay * variance) return std::nullopt;
  Series truth = record;
  truth.deflection_m = std::move(course.deflection_m);
  truth.velocity_mps = std::move(course.velocity_mps);
  Series out = surrogate_of(record, truth, record.force_n, force_noise_n, 0.0, seed);
  out.left_out.resize(0);
  leave_rest_out(out);
  return out;
}

double resolution_of(const Eigen::VectorXd& values) {
  const double least = kFewestStepShare * (values.maxCoeff() - values.minCoeff());
  std::vector<double> differences;
  for (Eigen::Index i = 1; i < values.size(); ++i) {
    const double d = std::abs(values[i] - values[i - 1]);
    if (d > least) differences.push_back(d);
  }
  if (differences.size() < 10) return 0.0;
  double step = *std::min_element(differences.begin(), differences.end());
  const auto whole = std::count_if(differences.begin(), differences.end(), [step](double d) {
    const double steps = d / step;
    return std::abs(steps - std::round(steps)) < kWhole * std::max(1.0, 0.1 * steps);
  });
  const auto count = static_cast<double>(differences.size());
  const bool varied = *std::max_element(differences.begin(), differences.end()) > 1.5 * step;
  return varied && static_cast<double>(whole) > kMostlyWhole * count ? step : 0.0;
}

double white_noise(const Eigen::VectorXd& values) {
  std::vector<double> fourth;
  std::vector<double> eighth;
  for (Eigen::Index i = 8; i < values.size(); ++i) {
    const auto about = [&](int j) { return values[i - 4 + j]; };
    fourth.push_back(std::abs(core::fourth_difference(about)));
    eighth.push_back(std::abs(core::eighth_difference(about)));
  }
  if (fourth.empty()) return 0.0;
  return std::max(core::white_sigma(median_of(fourth), median_of(eighth)),
                  resolution_of(values) / std::sqrt(12.0));
}

Floor surrogate_floor(const std::vector<Series>& records, const Law& law) {
  Floor out;
  std::vector<Series> surrogates;
  std::uint64_t seed = kSeed;
  double noise_nmse = 0.0;
  for (const Series& record : records) {
    const Series truth = true_motion(record);
    const Eigen::VectorXd force = force_of(law, truth);
    const double period = period_of(record.deflection_m);
    const double noise_n = force_noise(record, force, period);
    std::optional<Series> moved;
    if (law.moves) moved = moved_surrogate(record, *law.moves, noise_n, seed);
    surrogates.push_back(moved ? std::move(*moved)
                               : surrogate_of(record, truth, force, noise_n, period, seed));
    ++seed;
    if (surrogates.back().size() < record.size() / 2) return out;
    const double variance = (record.force_n.array() - record.force_n.mean()).square().mean();
    noise_nmse += noise_n * noise_n / (variance * static_cast<double>(records.size()));
  }
  out.nmse = left_of(surrogates, law);
  if (out.nmse > 0.0) out.noise_share = std::min(noise_nmse / out.nmse, 1.0);
  return out;
}

}  // namespace dampline::app::rig
