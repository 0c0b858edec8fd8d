// SPDX-License-Identifier: MIT
#include "app/wavelet/measured.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "app/error.hpp"
#include "app/identify/collected.hpp"
#include "app/record/columns.hpp"
#include "app/rig/record.hpp"
#include "app/wavelet/deflections.hpp"
#include "app/wavelet/masses.hpp"

namespace dampline::app::wavelet {
namespace {

constexpr std::size_t kFewestSamples = 100;

/// Puts the samples of a record one behind the other, and notes what is missing.
class Gatherer {
 public:
  Gatherer(Measured& out, double interval_s) : out_{out}, clock_{out.name, interval_s} {}

  void take(const MassLine& line) {
    const rig::core::Sample at =
        clock_.sample({.line = line.line, .time_s = line.time_s, .deflection_m = line.first[0]});
    if (at.tick <= last_tick_) {
      ++repeated_;
      return;
    }
    if (last_tick_ >= 0 && at.tick > last_tick_ + 1) {
      ++gaps_;
      lost_ += static_cast<std::uint64_t>(at.tick - last_tick_ - 1);
      excluded_.add(seconds(last_tick_ + 1), seconds(at.tick), "gap in the record");
      end_stretch();
    }
    last_tick_ = at.tick;
    add(line, at.tick);
  }

  void finish() {
    end_stretch();
    clock_.check_uniform();
    out_.step_s = clock_.mean_interval_s();
    for (double& t : out_.time_s) t *= out_.step_s;
    out_.duration_s = out_.step_s * static_cast<double>(last_tick_ + 1);
    out_.reading.origin.recorded = clock_.recorded();
    out_.reading.excluded = excluded_.list();
    out_.reading.excluded_more = excluded_.more();
    out_.reading.counts.insert(out_.reading.counts.begin(), {{"samples", clock_.rows()},
                                                             {"gaps", gaps_},
                                                             {"lost", lost_},
                                                             {"repeated", repeated_},
                                                             {"not_finite", not_finite_}});
  }

 private:
  [[nodiscard]] double seconds(std::int64_t tick) const {
    return static_cast<double>(tick) * clock_.interval_s();
  }

  void add(const MassLine& line, std::int64_t tick) {
    bool finite = std::isfinite(line.time_s);
    for (std::size_t m = 0; m < static_cast<std::size_t>(out_.masses); ++m)
      finite = finite && std::isfinite(line.first[m]) && std::isfinite(line.second[m]);
    if (!finite) {
      ++not_finite_;
      excluded_.add(seconds(tick), seconds(tick + 1), "a value that is no number");
      end_stretch();
      return;
    }
    out_.time_s.push_back(static_cast<double>(tick));  // in steps until finish()
    for (std::size_t m = 0; m < static_cast<std::size_t>(out_.masses); ++m) {
      out_.deflection_m[m].push_back(line.first[m]);
      out_.force_n[m].push_back(line.second[m]);
    }
  }

  void end_stretch() {
    const std::size_t end = out_.time_s.size();
    if (end > begin_) out_.stretches.push_back({begin_, end});
    begin_ = end;
  }

  Measured& out_;
  rig::Clock clock_;
  ExcludedList excluded_;
  std::size_t begin_{0};
  std::int64_t last_tick_{-1};
  std::uint64_t gaps_{0};
  std::uint64_t lost_{0};
  std::uint64_t repeated_{0};
  std::uint64_t not_finite_{0};
};

double median_interval_s(const std::string& name, const std::vector<MassLine>& lines) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < lines.size(); ++i)
    if (const double h = lines[i].time_s - lines[i - 1].time_s; h > 0.0) intervals.push_back(h);
  if (intervals.size() < kFewestSamples)
    throw RunError{fmt::format("{}: found {} rows whose time advances, expected at least {}", name,
                               intervals.size(), kFewestSamples)};
  return rig::median_of(intervals);
}

Measured read_masses(const MeasuredOptions& options) {
  Measured out;
  out.name = options.source.path;
  out.masses = options.masses;
  MassLines read = read_mass_lines(options.source, options.masses, out.reading);
  out.notes = std::move(read.notes);
  Gatherer gatherer{out, median_interval_s(out.name, read.lines)};
  for (const MassLine& line : read.lines) gatherer.take(line);
  gatherer.finish();
  return read.accelerations ? deflections_from_accelerations(out, options.block_s) : out;
}

Measured read_rig(const Config& config, const MeasuredOptions& options) {
  const RecognisedColumns seen = recognise_columns(config, options.source);
  const rig::Record record =
      rig::csv_record(options.source.path, seen.config.input, options.source.skip_bad_lines);
  Measured out;
  out.name = record.name;
  out.notes = seen.notes;
  out.file_force_sign = record.force_sign;
  Gatherer gatherer{out, rig::measure_interval_s(record)};
  const auto source = record.open();
  for (rig::Line line; source->next(line);)
    gatherer.take({.line = line.line,
                   .time_s = line.time_s,
                   .first = {line.deflection_m, 0.0},
                   .second = {line.force_n, 0.0}});
  gatherer.finish();
  source->report(out.reading);
  out.reading.faults = record.faults;
  if (source->has_velocity())
    out.notes.emplace_back("velocity_mps was not used: the rows derive it from the deflection.");
  return out;
}

/// Samples between reversals of more than a tenth of the range, twice; 0: fewer than three.
double period_of(const std::vector<double>& x, const std::vector<Stretch>& stretches) {
  constexpr double kTurn = 0.1;
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  const double turn = kTurn * (*high - *low);
  std::size_t reversals = 0;
  std::size_t samples = 0;
  for (const Stretch& s : stretches) {
    double extreme = x[s.begin];
    bool up = true;
    for (std::size_t i = s.begin; i < s.end; ++i) {
      const double back = up ? extreme - x[i] : x[i] - extreme;
      if (back < 0.0) extreme = x[i];
      if (back < turn || turn == 0.0) continue;
      ++reversals;
      up = !up;
      extreme = x[i];
    }
    samples += s.end - s.begin;
  }
  return reversals < 3 ? 0.0 : 2.0 * static_cast<double>(samples) / static_cast<double>(reversals);
}

}  // namespace

Measured read_measured(const Config& config, const MeasuredOptions& options) {
  if (options.source.path == "-")
    throw RunError{
        "-: such a record is read several times and cannot come from standard input; "
        "expected a CSV file"};
  const bool several = options.masses > 1 || has_base_and_response(options.source.path);
  Measured out = several ? read_masses(options) : read_rig(config, options);
  if (out.samples() < kFewestSamples)
    throw RunError{fmt::format("{}: found {} samples that are numbers, expected at least {}",
                               out.name, out.samples(), kFewestSamples)};
  return out;
}

double samples_per_period(const Measured& measured) {
  double out = period_of(measured.deflection_m[0], measured.stretches);
  if (measured.masses == 1) return out;
  std::vector<double> between = measured.deflection_m[1];
  for (std::size_t i = 0; i < between.size(); ++i) between[i] -= measured.deflection_m[0][i];
  const double other = period_of(between, measured.stretches);
  return out == 0.0 || other == 0.0 ? std::max(out, other) : std::min(out, other);
}

}  // namespace dampline::app::wavelet
