// SPDX-License-Identifier: MIT
#include "app/rig/uniform_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "app/error.hpp"
#include "app/rig/rig_clock.hpp"

namespace dampline::app {
namespace {

constexpr double kGapIntervals = 5.0;
constexpr std::size_t kFewestRows = 100;

using Lines = std::vector<RigLine>;

/// Rows that are in memory.
class MemorySource final : public RigSource {
 public:
  MemorySource(std::shared_ptr<const Lines> lines, std::shared_ptr<const RigSource> first,
               std::string note)
      : lines_{std::move(lines)}, first_{std::move(first)}, note_{std::move(note)} {}
  bool next(RigLine& line) override {
    if (next_ == lines_->size()) return false;
    line = (*lines_)[next_++];
    return true;
  }
  [[nodiscard]] bool has_velocity() const override { return first_->has_velocity(); }
  void report(RunResult& result) const override {
    first_->report(result);
    result.notes.push_back(note_);
  }

 private:
  std::shared_ptr<const Lines> lines_;
  std::shared_ptr<const RigSource> first_;  ///< that read the file
  std::string note_;
  std::size_t next_{0};
};

struct Times {
  double median_s{0.0};
  double least_s{0.0};  ///< but 0
  double irregular_share{0.0};
  double uneven_share{0.0};  ///< of the steps that are not one interval
  bool judged{false};  ///< false: too few, or time goes back or is missing, which RigClock reports
};

Times times_of(const Lines& lines) {
  Times out;
  std::vector<double> steps;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const double step = lines[i].time_s - lines[i - 1].time_s;
    if (!(step >= 0.0)) return out;
    steps.push_back(step);
    if (step > 0.0 && (out.least_s == 0.0 || step < out.least_s)) out.least_s = step;
  }
  if (steps.size() < kFewestRows || out.least_s == 0.0) return out;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  out.median_s = *middle;
  if (!(out.median_s > 0.0))
    out.median_s =
        (lines.back().time_s - lines.front().time_s) / static_cast<double>(lines.size() - 1);
  const auto irregular = std::count_if(steps.begin(), steps.end(), [&](double step) {
    const double samples = step / out.median_s;
    return std::abs(samples - std::max(1.0, std::round(samples))) > RigClock::kIrregularSamples;
  });
  out.irregular_share = static_cast<double>(irregular) / static_cast<double>(steps.size());
  const auto uneven = std::count_if(steps.begin(), steps.end(), [&](double step) {
    return std::abs(step / out.median_s - 1.0) > RigClock::kIrregularSamples;
  });
  out.uneven_share = static_cast<double>(uneven) / static_cast<double>(steps.size());
  out.judged = true;
  return out;
}

/// Puts rounded times back onto their line. False: it is more than rounding.
bool straighten(Lines& lines, const Times& times) {
  const double start_s = lines.front().time_s;
  const double step_s = (lines.back().time_s - start_s) / static_cast<double>(lines.size() - 1);
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (std::abs(lines[i].time_s - start_s - step_s * static_cast<double>(i)) >
        1.01 * times.least_s)
      return false;
  for (std::size_t i = 0; i < lines.size(); ++i)
    lines[i].time_s = start_s + step_s * static_cast<double>(i);
  return true;
}

double slope(const RigLine& a, const RigLine& b) {
  return (b.deflection_m - a.deflection_m) / (b.time_s - a.time_s);
}

/// The deflection between two rows by a cubic with the slopes of their neighbours' parabolas,
/// everything else by a straight line: a force may jump.
RigLine between(const Lines& lines, std::size_t i, double time_s) {
  const RigLine& a = lines[i];
  const RigLine& b = lines[i + 1];
  const double h = b.time_s - a.time_s;
  const double u = (time_s - a.time_s) / h;
  RigLine out = a;
  out.time_s = time_s;
  const auto line = [u](double from, double to) { return from + u * (to - from); };
  out.velocity_mps = line(a.velocity_mps, b.velocity_mps);
  out.force_n = line(a.force_n, b.force_n);
  out.accel_mps2 = line(a.accel_mps2, b.accel_mps2);
  const double middle = slope(a, b);
  double left = middle;
  double right = middle;
  if (i > 0) {
    const double before = a.time_s - lines[i - 1].time_s;
    left = (h * slope(lines[i - 1], a) + before * middle) / (h + before);
  }
  if (i + 2 < lines.size()) {
    const double after = lines[i + 2].time_s - b.time_s;
    right = (h * slope(b, lines[i + 2]) + after * middle) / (h + after);
  }
  const double w = 1.0 - u;
  out.deflection_m = line(a.deflection_m, b.deflection_m) +
                     h * u * w * (w * (left - middle) - u * (right - middle));
  return out;
}

Lines resampled(const Lines& lines, double step_s) {
  Lines out;
  std::size_t i = 0;
  const double start_s = lines.front().time_s;
  for (std::size_t k = 0;; ++k) {
    const double time_s = start_s + step_s * static_cast<double>(k);
    while (i + 1 < lines.size() && lines[i + 1].time_s < time_s) ++i;
    if (i + 1 >= lines.size()) return out;
    if (lines[i + 1].time_s - lines[i].time_s > kGapIntervals * step_s) continue;
    out.push_back(between(lines, i, time_s));
  }
}

void check_advance(const std::string& name, const Lines& lines) {
  for (std::size_t i = 1; i < lines.size(); ++i)
    if (!(lines[i].time_s > lines[i - 1].time_s))
      throw RunError{fmt::format(
          "{}:{}: time_s: found {:.9g} s twice, expected time to advance (are digits missing?)",
          name, lines[i].line, lines[i].time_s)};
}

}  // namespace

RigRecord uniform_record(RigRecord record) {
  const std::shared_ptr<RigSource> source = record.open();
  auto lines = std::make_shared<Lines>();
  for (RigLine line; source->next(line);) lines->push_back(line);
  const Times times = times_of(*lines);
  if (!times.judged || times.uneven_share <= RigClock::kIrregularShare) return record;
  if (straighten(*lines, times)) {
    record.notes.emplace_back("The times are rounded: they were put onto a straight line.");
  } else if (times.irregular_share <= RigClock::kIrregularShare) {
    return record;  // with gaps of whole samples
  } else {
    check_advance(record.name, *lines);
    const double mean_s =
        (lines->back().time_s - lines->front().time_s) / static_cast<double>(lines->size() - 1);
    const double step_s = std::min(times.median_s, mean_s);
    *lines = resampled(*lines, step_s);
    record.notes.push_back(fmt::format(
        "The times are not uniform ({:.0f} % of the intervals): resampled every {:.4g} ms.",
        100.0 * times.irregular_share, 1e3 * step_s));
  }
  record.open = [lines, source, note = record.notes.back()]() -> std::unique_ptr<RigSource> {
    return std::make_unique<MemorySource>(lines, source, note);
  };
  return record;
}

}  // namespace dampline::app
