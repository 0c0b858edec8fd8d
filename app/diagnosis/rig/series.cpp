// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "app/error.hpp"
#include "app/law/start.hpp"
#include "app/rig/record.hpp"
#include "app/rig/result.hpp"
#include "dampline/rig/motion.hpp"
#include "dampline/rig/survey.hpp"
#include "drivers/record/rows.hpp"

namespace dampline::app::rig {
namespace {

constexpr double kFirstPart = 0.25;  // of a period

/// x'' over the first quarter of a period, by a parabola through its mean, its rise and its bend.
double first_accel(const Eigen::VectorXd& x, double hz, double interval_s) {
  const auto samples = static_cast<Eigen::Index>(kFirstPart / (hz * interval_s));
  const Eigen::Index third = std::min(std::max<Eigen::Index>(samples / 3, 1), x.size() / 3);
  if (third == 0) return 0.0;
  const double length_s = static_cast<double>(third) * interval_s;
  return (x.segment(0, third).mean() - 2.0 * x.segment(third, third).mean() +
          x.segment(2 * third, third).mean()) /
         (length_s * length_s);
}

/// As if the mass had followed its foot so far: at its speed, held back by its acceleration.
void start_along(const Eigen::VectorXd& x, double v, const Mode& mode, double interval_s,
                 core::Resonance& resonance) {
  const double w = 2.0 * std::numbers::pi * mode.hz;
  const double back = first_accel(x, mode.hz, interval_s) / (w * w);
  resonance.start(x[0] - back - 2.0 * mode.damping * v / w, v / w);
}

constexpr double kSlowHz = 5.0;

constexpr double kRestPeriods = 0.35;       // that the deflection stays within kStill
constexpr Eigen::Index kFewestAtRest = 25;  // samples
constexpr double kStill = 0.02;             // of its range
constexpr double kUntilTurned = 0.5;        // periods after a rest, at most, until the motion turns
constexpr double kCycle = 2.0;              // ranges: to and fro
constexpr int kStepPlaces = 10;
constexpr double kMostRest = 0.8;  // of the record: more is its own kind of motion

/// 1 where the deflection stays within `reach_m` for `window` samples.
Eigen::VectorXd at_rest(const Eigen::VectorXd& x, Eigen::Index window, double reach_m) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(x.size());
  Eigen::Index from = 0;
  while (from + window <= x.size()) {
    double low = x[from];
    double high = x[from];
    Eigen::Index to = from;
    for (; to < x.size(); ++to) {
      low = std::min(low, x[to]);
      high = std::max(high, x[to]);
      if (high - low > reach_m) break;
    }
    if (to - from >= window) out.segment(from, to - from).setOnes();
    from = to - from >= window ? to : from + std::max<Eigen::Index>(1, (to - from) / 8);
  }
  return out;
}

/// One column, row by row.
std::vector<double> read_column(const std::string& path, const std::string& column,
                                bool skip_bad_lines) {
  drivers::RowFileConfig config;
  config.path = path;
  config.optional = {column};
  config.skip_bad_lines = skip_bad_lines;
  const auto reader = drivers::open_rows(config);
  if (!reader) throw RunError{reader.error_text()};
  std::vector<double> out;
  if (!reader.value()->has(column)) return out;
  std::array<double, 1> row{};
  for (auto rows = reader.value()->read(row); rows; rows = reader.value()->read(row))
    if (rows.value() > 0) out.push_back(row[0]);
  return out;
}

/// Where no deflection is the rest position, their mean is: a spring, a stop or a curve about a
/// zero that lies outside the motion says nothing.
void centre(Series& series) {
  if (series.size() == 0) return;
  const double low = series.deflection_m.minCoeff();
  const double high = series.deflection_m.maxCoeff();
  if (low <= 0.0 && high >= 0.0) return;
  const double mean = series.deflection_m.mean();
  series.deflection_m.array() -= mean;
  series.zero_m = mean;
  series.notes.push_back(
      fmt::format("Zero deflection lies outside the motion, {:.6g} to {:.6g} m: counted from the "
                  "mean, {:.6g} m.",
                  low, high, mean));
}

struct ReadRows {
  std::vector<core::Sample> samples;
  std::vector<double> time_s;
  std::vector<double> accel_mps2;
  bool has_accel{false};
};

ReadRows read_rows(const Record& record, Clock& clock, core::Survey& survey) {
  ReadRows out;
  const auto source = record.open();
  Line line;
  while (source->next(line)) {
    out.samples.push_back(clock.sample(line));
    out.time_s.push_back(line.time_s);
    out.accel_mps2.push_back(line.accel_mps2);
    out.has_accel = out.has_accel || std::isfinite(line.accel_mps2);
    survey.update(out.samples.back());
  }
  clock.check_uniform();
  return out;
}

}  // namespace

/// Standstill says nothing of a law of motion, nor does the way to the next reversal, where what
/// friction remembers is of the time before.
void leave_rest_out(Series& series) {
  const Eigen::VectorXd& x = series.deflection_m;
  const Eigen::VectorXd& v = series.velocity_mps;
  if (x.size() == 0) return;
  const double period = law::period_of(x, v) / series.interval_s;
  const auto window = std::max(kFewestAtRest, static_cast<Eigen::Index>(kRestPeriods * period));
  if (!std::isfinite(period)) return;
  Eigen::VectorXd out = at_rest(x, window, kStill * (x.maxCoeff() - x.minCoeff()));
  const auto most = static_cast<Eigen::Index>(kUntilTurned * period);
  for (Eigen::Index i = 1; i < x.size(); ++i) {
    if (out[i] > 0.0 || out[i - 1] == 0.0) continue;
    Eigen::Index to = i;
    while (to < std::min(i + most, x.size()) && v[to] * v[i] > 0.0) ++to;
    out.segment(i, to - i).setOnes();
    i = to;
  }
  const double share = out.mean();
  if (share == 0.0 || share > kMostRest) return;
  series.left_out = Series::kRest * out;
  series.notes.push_back(fmt::format(
      "Standstill, and the way from it to the next reversal, is left out: {:.1f} % of the record.",
      100.0 * share));
}

double between(const Eigen::VectorXd& y, double place) {
  const auto last = static_cast<double>(y.size() - 1);
  const double at = std::clamp(place, 0.0, last);
  const auto i = std::min(static_cast<Eigen::Index>(at), y.size() - 2);
  const double u = at - static_cast<double>(i);
  const double before = y[std::max<Eigen::Index>(i - 1, 0)];
  const double after = y[std::min(i + 2, y.size() - 1)];
  const double a = y[i];
  const double b = y[i + 1];
  const double slope_a = 0.5 * (b - before);
  const double slope_b = 0.5 * (after - a);
  const double square = u * u;
  const double cube = square * u;
  return (2.0 * cube - 3.0 * square + 1.0) * a + (cube - 2.0 * square + u) * slope_a +
         (3.0 * square - 2.0 * cube) * b + (cube - square) * slope_b;
}

Eigen::VectorXd through_mode(const Eigen::VectorXd& u, const Mode& mode, double interval_s) {
  if (!(mode.hz > 0.0)) return u;
  core::Resonance resonance{mode, interval_s};
  Eigen::VectorXd out{u.size()};
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    if (i == 0)
      resonance.start(u[0]);
    else
      resonance.advance(u[i - 1], u[i]);
    out[i] = resonance.value();
  }
  return out;
}

Eigen::VectorXd attached_accel(const Eigen::VectorXd& x, const Eigen::VectorXd& v, const Mode& mode,
                               double interval_s) {
  const double w = 2.0 * std::numbers::pi * mode.hz;
  const double d = 2.0 * mode.damping;
  core::Resonance resonance{mode, interval_s};
  Eigen::VectorXd out{x.size()};
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    if (i == 0)
      start_along(x, v[0], mode, interval_s, resonance);
    else
      resonance.advance(x[i - 1], x[i]);
    // y = p + D' p' / w, and p'' / w^2 = x - p - D' p' / w.
    const double p = resonance.value();
    const double rate = resonance.rate_over_w();
    const double left = x[i] - p - d * rate;
    out[i] = w * w * (left + d * (v[i] / w - rate - d * left));
  }
  return out;
}

Series Series::part(Eigen::Index first, Eigen::Index count) const {
  Series out = *this;
  for (Eigen::VectorXd* values : {&out.time_s, &out.deflection_m, &out.velocity_mps, &out.force_n,
                                  &out.reference_n, &out.accel_mps2, &out.left_out})
    if (values->size() >= first + count) *values = Eigen::VectorXd{values->segment(first, count)};
  return out;
}

void Series::set_motion(const std::vector<core::Motion>& rows) {
  const auto count = static_cast<Eigen::Index>(rows.size());
  for (Eigen::VectorXd* values : {&deflection_m, &velocity_mps, &force_n}) values->resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const core::Motion& row = rows[static_cast<std::size_t>(i)];
    deflection_m[i] = row.deflection_m;
    velocity_mps[i] = row.velocity_mps;
    force_n[i] = row.force_n;
  }
}

namespace {

bool cycles_before_and_after(const Series& r, double share) {
  const double range_m = r.deflection_m.maxCoeff() - r.deflection_m.minCoeff();
  const auto before = static_cast<Eigen::Index>(share * static_cast<double>(r.size()));
  const double first_m = r.velocity_mps.head(before).cwiseAbs().sum() * r.interval_s;
  const double last_m = r.velocity_mps.tail(r.size() - before).cwiseAbs().sum() * r.interval_s;
  return std::min(first_m, last_m) >= kCycle * range_m;
}

}  // namespace

std::vector<double> places_of_steps(const std::vector<Series>& records) {
  std::vector<double> out;
  for (int place = 1; place < kStepPlaces; ++place) {
    const double share = static_cast<double>(place) / kStepPlaces;
    if (std::all_of(records.begin(), records.end(),
                    [share](const Series& r) { return cycles_before_and_after(r, share); }))
      out.push_back(share);
  }
  return out;
}

Series read_series(const std::string& path, const Config& config, bool skip_bad_lines,
                   const std::string& reference_column) {
  const Record record = csv_record(path, config.input, skip_bad_lines);
  Series out;
  out.record = path;
  out.notes = record.notes;
  out.faults = record.faults.list;
  out.force_sign = record.force_sign;
  Clock clock{record.name, measure_interval_s(record)};
  const bool measured = record.open()->has_velocity();
  core::Survey survey{1.0 / clock.interval_s(), measured};
  const ReadRows rows = read_rows(record, clock, survey);
  const auto settings =
      survey.suggest(terms_of(config.model), config.model.rig_corner_hz.value_or(0.0));
  if (!settings)
    throw RunError{fmt::format("{}: found no motion, expected a record of a rig that moves", path)};
  out.config = settings.value();
  out.noise_m = survey.deflection_noise_m();
  out.interval_s = clock.mean_interval_s();
  out.config.sample_rate_hz = 1.0 / out.interval_s;
  const std::vector<double> reference = reference_column.empty()
                                            ? std::vector<double>{}
                                            : read_column(path, reference_column, skip_bad_lines);

  core::MotionEstimator estimator{out.config};
  const auto late = static_cast<std::size_t>(estimator.latency_samples());
  std::vector<core::Motion> motions;
  std::vector<double> time_s;
  std::vector<double> reference_n;
  std::vector<double> accel_mps2;
  for (std::size_t i = 0; i < rows.samples.size(); ++i) {
    const core::Sample& sample = rows.samples[i];
    const bool gap = i > 0 && sample.tick != rows.samples[i - 1].tick + 1;
    const bool usable = core::is_finite(sample, measured);
    if (gap || !usable) estimator.reset();
    out.has_gap = out.has_gap || gap || !usable;
    core::Motion motion;
    if (!usable || !estimator.update(sample, motion)) continue;
    motions.push_back(motion);
    time_s.push_back(rows.time_s[i - late]);
    if (reference.size() == rows.samples.size())
      reference_n.push_back(record.force_sign * reference[i - late]);
    if (rows.has_accel) accel_mps2.push_back(rows.accel_mps2[i - late]);
  }
  out.set_motion(motions);
  out.time_s = vector_of(time_s);
  out.reference_n = vector_of(reference_n);
  out.accel_mps2 = vector_of(accel_mps2);
  if (1.0 / out.interval_s < kSlowHz)
    out.notes.push_back(fmt::format(
        "One sample every {:.4g} s: is time_s in s? If it is in ms: [input.scale] time_s = 0.001",
        out.interval_s));
  centre(out);
  leave_rest_out(out);
  return out;
}

}  // namespace dampline::app::rig
