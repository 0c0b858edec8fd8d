// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/rig_series.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "app/error.hpp"
#include "app/rig/csv_rig_source.hpp"
#include "app/rig/rig_clock.hpp"
#include "app/rig/rig_terms.hpp"
#include "dampline/rig/rig_motion.hpp"
#include "dampline/rig/rig_survey.hpp"
#include "drivers/csv/reader.hpp"

namespace dampline::app {
namespace {

constexpr double kSlowHz = 5.0;

Eigen::VectorXd vector_of(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// One column, row by row.
std::vector<double> read_column(const std::string& path, const std::string& column,
                                bool skip_bad_lines) {
  drivers::CsvConfig config;
  config.path = path;
  config.optional = {column};
  config.skip_bad_lines = skip_bad_lines;
  const auto reader = drivers::CsvReader::open(config);
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
void centre(RigSeries& series) {
  if (series.size() == 0) return;
  const double low = series.deflection_m.minCoeff();
  const double high = series.deflection_m.maxCoeff();
  if (low <= 0.0 && high >= 0.0) return;
  const double mean = series.deflection_m.mean();
  series.deflection_m.array() -= mean;
  series.notes.push_back(
      fmt::format("Zero deflection lies outside the motion, {:.6g} to {:.6g} m: counted from the "
                  "mean, {:.6g} m.",
                  low, high, mean));
}

struct Rows {
  std::vector<RigSample> samples;
  std::vector<double> time_s;
  std::vector<double> accel_mps2;
  bool has_accel{false};
};

Rows read_rows(const RigRecord& record, RigClock& clock, RigSurvey& survey) {
  Rows out;
  const auto source = record.open();
  RigLine line;
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

RigSeries read_rig_series(const std::string& path, const Config& config, bool skip_bad_lines,
                          const std::string& reference_column) {
  const RigRecord record = csv_rig_record(path, config.input, skip_bad_lines);
  RigSeries out;
  out.record = path;
  out.notes = record.notes;
  RigClock clock{record.name, measure_interval_s(record)};
  const bool measured = record.open()->has_velocity();
  RigSurvey survey{1.0 / clock.interval_s(), measured};
  const Rows rows = read_rows(record, clock, survey);
  const auto settings =
      survey.suggest(rig_terms(config.model), config.model.rig_corner_hz.value_or(0.0));
  if (!settings)
    throw RunError{fmt::format("{}: found no motion, expected a record of a rig that moves", path)};
  out.config = settings.value();
  out.noise_m = survey.deflection_noise_m();
  out.interval_s = clock.mean_interval_s();
  out.config.sample_rate_hz = 1.0 / out.interval_s;
  const std::vector<double> reference = reference_column.empty()
                                            ? std::vector<double>{}
                                            : read_column(path, reference_column, skip_bad_lines);

  RigMotionEstimator estimator{out.config};
  const auto late = static_cast<std::size_t>(estimator.latency_samples());
  std::array<std::vector<double>, 6> series;
  for (std::size_t i = 0; i < rows.samples.size(); ++i) {
    const RigSample& sample = rows.samples[i];
    const bool gap = i > 0 && sample.tick != rows.samples[i - 1].tick + 1;
    const bool usable = std::isfinite(sample.deflection_m) && std::isfinite(sample.force_n) &&
                        (!measured || std::isfinite(sample.velocity_mps));
    if (gap || !usable) estimator.reset();
    out.has_gap = out.has_gap || gap || !usable;
    RigMotion motion;
    if (!usable || !estimator.update(sample, motion)) continue;
    const std::size_t row = i - late;
    series[0].push_back(rows.time_s[row]);
    series[1].push_back(motion.deflection_m);
    series[2].push_back(motion.velocity_mps);
    series[3].push_back(motion.force_n);
    if (reference.size() == rows.samples.size()) series[4].push_back(reference[row]);
    if (rows.has_accel) series[5].push_back(rows.accel_mps2[row]);
  }
  out.time_s = vector_of(series[0]);
  out.deflection_m = vector_of(series[1]);
  out.velocity_mps = vector_of(series[2]);
  out.force_n = vector_of(series[3]);
  out.reference_n = vector_of(series[4]);
  out.accel_mps2 = vector_of(series[5]);
  if (1.0 / out.interval_s < kSlowHz)
    out.notes.push_back(fmt::format(
        "One sample every {:.4g} s: is time_s in s? If it is in ms: [input.scale] time_s = 0.001",
        out.interval_s));
  centre(out);
  return out;
}

}  // namespace dampline::app
