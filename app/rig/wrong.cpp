// SPDX-License-Identifier: MIT
#include "app/rig/wrong.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "app/error.hpp"

namespace dampline::app::rig {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kFewestJudged = 200;
constexpr double kUsualShare = 0.9;        // of the second differences
constexpr double kBeyond = 12.0;           // times that: an edge of something
constexpr std::size_t kLongestRun = 12;    // samples; what stays longer is no wrong value
constexpr std::size_t kReplaced = 3;       // samples in a row at most
constexpr std::size_t kAround = 8;         // samples on either side that a run is held against
constexpr double kUnlike = 4.0;            // times their second differences
constexpr double kAbove = 1.5;             // times their span
constexpr double kOutside = 0.5;           // of the usual range, beyond it
constexpr std::ptrdiff_t kMostWrong = 12;  // runs in a record; what comes oftener is the rig's own
constexpr double kBlow = 20.0;             // times the usual range: no blow is larger
constexpr double kFarSamples = 1e12;

/// A column of a record.
struct Channel {
  const char* name;
  const char* unit;
  double Line::*value;
  bool jumps;  ///< the quantity itself may change between two samples
  bool blows;  ///< and blows show in it
};
constexpr std::array kChannels{Channel{"deflection_m", "m", &Line::deflection_m, false, false},
                               Channel{"velocity_mps", "m/s", &Line::velocity_mps, true, false},
                               Channel{"force_n", "N", &Line::force_n, true, true},
                               Channel{"accel_mps2", "m/s^2", &Line::accel_mps2, true, true}};

/// Neighbouring samples, the last one included.
struct Run {
  std::size_t first, last;
  [[nodiscard]] std::size_t samples() const { return last - first + 1; }
};

double quantile(std::vector<double> values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

/// One channel's finite values, without the places where there are none. A wrong run begins with an
/// edge against what lies before it and ends with one against what follows; a friction that turns
/// has only the first, and a run within the force's range is wrong only where the motion did not
/// turn.
class Screen {
 public:
  Screen(std::vector<double> values, std::vector<double> deflection_m, bool jumps)
      : x_{std::move(values)}, deflection_m_{std::move(deflection_m)}, jumps_{jumps} {
    const double low = quantile(x_, 0.01);
    const double high = quantile(x_, 0.99);
    low_ = low - kOutside * (high - low);
    high_ = high + kOutside * (high - low);
    std::vector<double> bends;
    for (std::size_t i = 2; i < x_.size(); ++i)
      if (const double bend = std::abs(bend_to(i)); bend > 0.0) bends.push_back(bend);
    edge_ = bends.size() < kFewestJudged / 2 ? kNone : kBeyond * quantile(bends, kUsualShare);
  }

  /// Each with the value that stands there instead; NaN: none.
  struct Wrong {
    Run run{};
    double size{0.0};  ///< farthest from the line between the neighbours
    std::vector<double> instead{};
  };

  [[nodiscard]] std::vector<Wrong> find() {
    std::vector<Wrong> out;
    if (!(edge_ >= 0.0)) return out;
    for (const std::size_t i : {std::size_t{1}, std::size_t{0}})
      if (std::abs(bend_from(i)) > edge_ && is_wrong_end({i, i})) take({i, i}, out);
    for (std::size_t i = 2; i < x_.size(); ++i) {
      if (!(std::abs(bend_to(i)) > edge_)) continue;
      for (std::size_t last = i; last < std::min(i + kLongestRun, x_.size()); ++last) {
        const bool at_end = last + 2 >= x_.size();
        if (!at_end && !(std::abs(bend_from(last)) > edge_)) continue;
        const Run run{i, at_end ? x_.size() - 1 : last};
        if (!(at_end ? is_wrong_end(run) : is_wrong(run))) continue;
        take(run, out);
        i = run.last;
        break;
      }
    }
    return out;
  }

  /// Takes out what comes too often for errors and is small enough for a blow.
  void leave_blows(std::vector<Wrong>& found) const {
    const double largest = kBlow * (high_ - low_) / (1.0 + 2.0 * kOutside);
    const auto is_blow = [&](const Wrong& wrong) { return wrong.size < largest; };
    if (std::count_if(found.begin(), found.end(), is_blow) > kMostWrong)
      std::erase_if(found, is_blow);
  }

 private:
  /// What a straight line through the two before, or the two after, leaves of a value.
  [[nodiscard]] double bend_to(std::size_t i) const { return x_[i] - 2.0 * x_[i - 1] + x_[i - 2]; }
  [[nodiscard]] double bend_from(std::size_t i) const {
    return x_[i] - 2.0 * x_[i + 1] + x_[i + 2];
  }
  [[nodiscard]] bool is_outside(std::size_t i) const { return x_[i] < low_ || x_[i] > high_; }

  void take(const Run& run, std::vector<Wrong>& out) {
    Wrong wrong{run, 0.0, {}};
    std::vector<double> line;
    for (std::size_t i = run.first; i <= run.last; ++i) {
      line.push_back(line_at(run, i));
      wrong.size = std::max(wrong.size, std::abs(x_[i] - line.back()));
      wrong.instead.push_back(instead_at(run, i));
    }
    std::copy(line.begin(), line.end(), x_.begin() + static_cast<std::ptrdiff_t>(run.first));
    out.push_back(std::move(wrong));
  }

  [[nodiscard]] double line_at(const Run& run, std::size_t i) const {
    if (run.first == 0) return x_[run.last + 1];
    const double before = x_[run.first - 1];
    if (run.last + 1 >= x_.size()) return before;
    const double share =
        static_cast<double>(i - run.first + 1) / static_cast<double>(run.samples() + 1);
    return before + share * (x_[run.last + 1] - before);
  }

  /// A cubic through two neighbours on either side, a line where the quantity may jump; nothing for
  /// long runs, and at the record's ends.
  [[nodiscard]] double instead_at(const Run& run, std::size_t i) const {
    if (run.samples() > kReplaced || run.first < 2 || run.last + 2 >= x_.size()) return kNone;
    if (jumps_) return line_at(run, i);
    const std::array<std::size_t, 4> at{run.first - 2, run.first - 1, run.last + 1, run.last + 2};
    double out = 0.0;
    for (const std::size_t j : at) {
      double weight = x_[j];
      for (const std::size_t k : at)
        if (k != j)
          weight *= (static_cast<double>(i) - static_cast<double>(k)) /
                    (static_cast<double>(j) - static_cast<double>(k));
      out += weight;
    }
    return out;
  }

  /// What the samples on either side bend by themselves; beside a jump its size counts.
  [[nodiscard]] double usual_near(const Run& run) const {
    double bend = 0.0;
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    const auto look = [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i) {
        low = std::min(low, x_[i]);
        high = std::max(high, x_[i]);
        if (i >= from + 2) bend = std::max(bend, std::abs(bend_to(i)));
      }
    };
    look(run.first - std::min(run.first, kAround), run.first);
    look(std::min(run.last + 1, x_.size()), std::min(run.last + 1 + kAround, x_.size()));
    return jumps_ ? std::min(kUnlike * bend, kAbove * (high - low)) : kUnlike * bend;
  }

  [[nodiscard]] bool is_wrong(const Run& run) const {
    const double edge = std::min(std::abs(bend_to(run.first)), std::abs(bend_from(run.last)));
    if (!(edge > usual_near(run))) return false;
    if (!jumps_) return true;
    return is_outside(run.first) || is_outside(run.last) || moves_one_way(run);
  }
  /// Of a run that nothing follows, or that nothing precedes.
  [[nodiscard]] bool is_wrong_end(const Run& run) const {
    const double edge =
        run.first < 2 ? std::abs(bend_from(run.last)) : std::abs(bend_to(run.first));
    return edge > usual_near(run) && (!jumps_ || is_outside(run.first));
  }

  /// From the sample before the run to the one after it, in every step.
  [[nodiscard]] bool moves_one_way(const Run& run) const {
    const double way_m = deflection_m_[run.last + 1] - deflection_m_[run.first - 1];
    for (std::size_t i = run.first; i <= run.last + 1; ++i)
      if (!((deflection_m_[i] - deflection_m_[i - 1]) * way_m > 0.0)) return false;
    return true;
  }

  std::vector<double> x_;
  std::vector<double> deflection_m_;
  bool jumps_;
  double edge_{kNone};
  double low_{0.0};
  double high_{0.0};
};

using Lines = std::vector<Line>;
using Changes = std::map<std::size_t, Line>;  ///< by row

/// Takes the wrong values of one channel out of the lines.
void screen_channel(const Channel& channel, Lines& lines, Changes& changes, DataFaults& faults) {
  std::vector<double> values;
  std::vector<double> deflection_m;
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!std::isfinite(lines[i].*channel.value)) continue;
    values.push_back(lines[i].*channel.value);
    deflection_m.push_back(lines[i].deflection_m);
    rows.push_back(i);
  }
  if (values.size() < kFewestJudged) return;
  constexpr std::size_t kMostSpans = 100;
  const double start_s = lines.front().time_s;
  const auto since_s = [&](std::size_t at) { return lines[rows[at]].time_s - start_s; };
  FaultFinding fault{"wrong_value", channel.name, 0.0, 0.0, 0.0, channel.unit, 0, {}};
  Screen screen{std::move(values), std::move(deflection_m), channel.jumps};
  std::vector<Screen::Wrong> found = screen.find();
  if (channel.blows) screen.leave_blows(found);
  for (const Screen::Wrong& wrong : found) {
    const auto& [first, last] = wrong.run;
    for (std::size_t i = first; i <= last; ++i) {
      Line& line = lines[rows[i]];
      line.*channel.value = wrong.instead[i - first];
      changes.insert_or_assign(rows[i], line);
      ++(std::isfinite(line.*channel.value) ? faults.values_replaced : faults.samples_spoilt);
    }
    fault.time_s = fault.count == 0 ? since_s(first) : std::min(fault.time_s, since_s(first));
    fault.last_s = std::max(fault.last_s, since_s(last));
    fault.size = std::max(fault.size, wrong.size);
    fault.count += wrong.run.samples();
    if (fault.spans.size() < kMostSpans) fault.spans.push_back({since_s(first), since_s(last)});
  }
  if (fault.count > 0) faults.list.push_back(std::move(fault));
}

/// Rows of a longest part of the record whose times do not go back.
std::vector<std::size_t> rows_in_order(const Lines& lines) {
  std::vector<std::size_t> tails;  // by length: the row with the earliest time that ends one
  std::vector<std::size_t> before(lines.size(), lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double time_s = lines[i].time_s;
    if (!std::isfinite(time_s)) continue;
    const auto at =
        std::upper_bound(tails.begin(), tails.end(), time_s,
                         [&](double t, std::size_t row) { return t < lines[row].time_s; });
    if (at != tails.begin()) before[i] = *(at - 1);
    if (at == tails.end())
      tails.push_back(i);
    else
      *at = i;
  }
  std::vector<std::size_t> out;
  for (std::size_t i = tails.empty() ? lines.size() : tails.back(); i < lines.size(); i = before[i])
    out.push_back(i);
  std::reverse(out.begin(), out.end());
  return out;
}

/// Without what lies so far from the middle that no clock counts it.
void leave_ends_out(const Lines& lines, std::vector<std::size_t>& rows) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < rows.size(); ++i)
    steps.push_back(lines[rows[i]].time_s - lines[rows[i - 1]].time_s);
  const double most_s = kFarSamples * quantile(steps, 0.5);
  if (!(most_s > 0.0)) return;
  std::size_t first = rows.size() / 2;
  std::size_t last = first;
  while (first > 0 && steps[first - 1] <= most_s) --first;
  while (last + 1 < rows.size() && steps[last] <= most_s) ++last;
  rows = {rows.begin() + static_cast<std::ptrdiff_t>(first),
          rows.begin() + static_cast<std::ptrdiff_t>(last + 1)};
}

/// Lines whose time is no number, or is not in order. Throws RunError for the first that is out of
/// order, but where lines are skipped.
std::vector<bool> wrong_times(const std::string& name, const Lines& lines, bool skip_bad_lines,
                              DataFaults& faults) {
  std::vector<std::size_t> kept = rows_in_order(lines);
  if (kept.size() < kFewestJudged) return {};
  leave_ends_out(lines, kept);
  std::vector<bool> out(lines.size(), true);
  for (const std::size_t row : kept) out[row] = false;
  FaultFinding fault{"wrong_time", "time_s", 0.0, 0.0, 0.0, "s", 0, {}};
  double last_s = lines[kept.front()].time_s;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double time_s = lines[i].time_s;
    if (!out[i]) last_s = time_s;
    if (!out[i] || (!skip_bad_lines && !std::isfinite(time_s))) continue;
    if (!skip_bad_lines)
      throw RunError{
          fmt::format("{}:{}: time_s: found {:.9g} s after {:.9g} s, expected time to "
                      "advance (--skip-bad-lines drops such lines)",
                      name, lines[i].line, time_s, last_s)};
    const double since_s = last_s - lines[kept.front()].time_s;
    if (fault.count == 0) fault.time_s = since_s;
    ++fault.count;
    fault.last_s = since_s;
    fault.size = std::max(fault.size, std::abs(time_s - last_s));
  }
  if (fault.count == 0) return {};
  faults.list.push_back(fault);
  return out;
}

std::string note_of(const FaultFinding& fault) {
  const bool time = fault.name == "wrong_time";
  return fmt::format("{} in {}: {}, the first at {:.3f} s; {}.",
                     time ? "Wrong times" : "Wrong values", fault.channel, fault.count,
                     fault.time_s,
                     time ? "their lines were dropped"
                          : "replaced by what their neighbours say, or left out where they are "
                            "more than three in a row");
}

/// Another source with some lines changed, some dropped.
class ScreenedSource final : public Source {
 public:
  ScreenedSource(std::unique_ptr<Source> inner, std::shared_ptr<const Changes> changes,
                 std::shared_ptr<const std::vector<bool>> dropped, std::vector<std::string> notes)
      : inner_{std::move(inner)},
        changes_{std::move(changes)},
        dropped_{std::move(dropped)},
        notes_{std::move(notes)} {}
  bool next(Line& line) override {
    do {
      if (!inner_->next(line)) return false;
      ++read_;
    } while (read_ <= dropped_->size() && (*dropped_)[read_ - 1]);
    const auto change = changes_->find(kept_++);
    if (change != changes_->end()) line = change->second;
    return true;
  }
  [[nodiscard]] bool has_velocity() const override { return inner_->has_velocity(); }
  void report(RunResult& result) const override {
    inner_->report(result);
    result.notes.insert(result.notes.end(), notes_.begin(), notes_.end());
    const auto count =
        static_cast<std::uint64_t>(std::count(dropped_->begin(), dropped_->end(), true));
    if (count == 0) return;
    const auto known =
        std::find_if(result.counts.begin(), result.counts.end(),
                     [](const auto& named) { return named.first == "lines_malformed"; });
    if (known == result.counts.end())
      result.counts.emplace_back("lines_malformed", count);
    else
      known->second += count;
  }

 private:
  std::unique_ptr<Source> inner_;
  std::shared_ptr<const Changes> changes_;
  std::shared_ptr<const std::vector<bool>> dropped_;
  std::vector<std::string> notes_;
  std::size_t read_{0};
  std::size_t kept_{0};
};

}  // namespace

Record screened_record(Record record, bool skip_bad_lines) {
  Lines lines;
  const auto source = record.open();
  for (Line line; source->next(line);) lines.push_back(line);
  if (lines.size() < kFewestJudged) return record;
  auto dropped = std::make_shared<std::vector<bool>>(
      wrong_times(record.name, lines, skip_bad_lines, record.faults));
  std::size_t row = 0;
  if (!dropped->empty())
    std::erase_if(lines, [&](const Line&) { return static_cast<bool>((*dropped)[row++]); });
  auto changes = std::make_shared<Changes>();
  for (const Channel& channel : kChannels) screen_channel(channel, lines, *changes, record.faults);
  if (record.faults.list.empty()) return record;
  std::vector<std::string> notes;
  for (const FaultFinding& fault : record.faults.list) notes.push_back(note_of(fault));
  record.notes.insert(record.notes.end(), notes.begin(), notes.end());
  record.open = [inner = record.open, changes, dropped, notes]() -> std::unique_ptr<Source> {
    return std::make_unique<ScreenedSource>(inner(), changes, dropped, notes);
  };
  return record;
}

}  // namespace dampline::app::rig
