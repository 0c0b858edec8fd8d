// SPDX-License-Identifier: MIT
#include "app/rig/consistent.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "dampline/numeric/mean_t.hpp"

namespace dampline::app::rig {
namespace {

constexpr std::size_t kFewestLines = 200;
constexpr double kTurn = 0.1;               // of the range of x: a reversal
constexpr Eigen::Index kLagsForRate = 100;  // the same for a velocity that is held against it
constexpr Eigen::Index kLagsOfPeriod = 24;  // in a period, of the differences
constexpr std::size_t kWorkBlocks = 40;
constexpr double kFeeds = 4.0;         // deviations below no work
constexpr double kElasticMost = 0.5;   // of the force's variance: spring and mass carry it
constexpr double kApart = 0.99;        // correlation above which spring and mass are one
constexpr double kRateRelated = 0.98;  // correlation of a velocity with the deflection's rate
constexpr double kOtherScale = 0.5;    // off by more: no sensitivity is so wrong
constexpr double kUnitWithin = 0.03;   // of a unit's factor

/// A row where motion and force are known.
struct Point {
  double deflection_m, rate, bend, velocity_mps, force_n;
};

std::vector<Line> lines_of(const Record& record) {
  const auto source = record.open();
  std::vector<Line> out;
  for (Line line; source->next(line);)
    if (std::isfinite(line.deflection_m) && std::isfinite(line.force_n)) out.push_back(line);
  return out;
}

/// Samples in a period of the motion: from reversal to reversal, twice.
Eigen::Index period_of(const std::vector<Line>& lines) {
  const auto [low, high] = std::minmax_element(
      lines.begin(), lines.end(),
      [](const Line& a, const Line& b) { return a.deflection_m < b.deflection_m; });
  const double turn_m = kTurn * (high->deflection_m - low->deflection_m);
  double extreme_m = lines.front().deflection_m;
  bool up = true;
  std::size_t reversals = 0;
  for (const Line& line : lines) {
    const double back_m = up ? extreme_m - line.deflection_m : line.deflection_m - extreme_m;
    if (back_m < 0.0) extreme_m = line.deflection_m;
    if (back_m < turn_m) continue;
    ++reversals;
    up = !up;
    extreme_m = line.deflection_m;
  }
  return static_cast<Eigen::Index>(2 * lines.size() / std::max<std::size_t>(reversals, 1));
}

std::vector<Point> points_of(const std::vector<Line>& lines, Eigen::Index lags) {
  const auto lag = static_cast<std::size_t>(std::max<Eigen::Index>(period_of(lines) / lags, 1));
  std::vector<Point> out;
  for (std::size_t i = lag; i + lag < lines.size(); ++i) {
    const Line& before = lines[i - lag];
    const Line& after = lines[i + lag];
    const double x = lines[i].deflection_m;
    out.push_back({x, (after.deflection_m - before.deflection_m) / (after.time_s - before.time_s),
                   after.deflection_m - 2.0 * x + before.deflection_m, lines[i].velocity_mps,
                   lines[i].force_n});
  }
  return out;
}

/// How sure it is that the force does work on the motion: of blocks.
double work_t(const std::vector<Point>& points) {
  double mean_n = 0.0;
  for (const Point& p : points) mean_n += p.force_n / static_cast<double>(points.size());
  std::array<double, kWorkBlocks> work{};
  for (std::size_t i = 0; i < points.size(); ++i)
    work[i * kWorkBlocks / points.size()] += (points[i].force_n - mean_n) * points[i].rate;
  MeanT mean;
  for (const double w : work) mean.add(w);
  return mean.t();
}

/// Whether a spring or a mass of the right sign carries the force.
bool is_elastic(const std::vector<Point>& points) {
  Eigen::MatrixXd columns{static_cast<Eigen::Index>(points.size()), 4};
  for (std::size_t i = 0; i < points.size(); ++i)
    columns.row(static_cast<Eigen::Index>(i)) << points[i].deflection_m, points[i].bend,
        points[i].rate, points[i].force_n;
  columns.rowwise() -= columns.colwise().mean().eval();
  const Eigen::RowVectorXd size = columns.colwise().norm();
  if (!(size.minCoeff() > 0.0)) return false;
  columns.array().rowwise() /= size.array();
  const Eigen::Matrix4d all = columns.transpose() * columns;
  Eigen::Matrix3d normal = all.topLeftCorner<3, 3>();
  normal.diagonal().array() += 1e-6;
  const Eigen::Vector3d share = normal.llt().solve(all.topRightCorner<3, 1>());
  const double both = share.head<2>().dot(all.topLeftCorner<2, 2>() * share.head<2>());
  if (both < kElasticMost) return false;
  if (std::abs(all(0, 1)) > kApart) return all(0, 3) > 0.0;
  return std::abs(share[0]) > std::abs(share[1]) ? share[0] > 0.0 : share[1] > 0.0;
}

/// Deflection's rate over the velocity that is said to be it; NaN where they are not related.
double rate_over_velocity(const std::vector<Point>& points) {
  double product = 0.0;
  double rates = 0.0;
  double velocities = 0.0;
  for (const Point& p : points) {
    if (!std::isfinite(p.velocity_mps)) continue;
    product += p.rate * p.velocity_mps;
    rates += p.rate * p.rate;
    velocities += p.velocity_mps * p.velocity_mps;
  }
  const double both = std::sqrt(rates * velocities);
  if (!(both > 0.0) || std::abs(product) < kRateRelated * both)
    return std::numeric_limits<double>::quiet_NaN();
  return product / velocities;
}

/// A power of ten, of one times an inch or a foot, or a dozen or a minute.
bool is_of_a_unit(double factor) {
  const double size = std::abs(factor);
  const auto near = [size](double unit) { return std::abs(std::log(size / unit)) < kUnitWithin; };
  for (const double unit : {1.0, 25.4, 3.048})
    if (near(unit * std::pow(10.0, std::round(std::log10(size / unit))))) return true;
  return near(12.0) || near(1.0 / 12.0) || near(60.0) || near(1.0 / 60.0);
}

class ConsistentSource final : public Source {
 public:
  ConsistentSource(std::unique_ptr<Source> inner, double force_sign, bool drops_velocity,
                   std::vector<std::string> notes)
      : inner_{std::move(inner)},
        force_sign_{force_sign},
        drops_velocity_{drops_velocity},
        notes_{std::move(notes)} {}
  bool next(Line& line) override {
    if (!inner_->next(line)) return false;
    line.force_n *= force_sign_;
    if (drops_velocity_) line.velocity_mps = std::numeric_limits<double>::quiet_NaN();
    return true;
  }
  [[nodiscard]] bool has_velocity() const override {
    return !drops_velocity_ && inner_->has_velocity();
  }
  void report(RunResult& result) const override {
    inner_->report(result);
    result.notes.insert(result.notes.end(), notes_.begin(), notes_.end());
  }

 private:
  std::unique_ptr<Source> inner_;
  double force_sign_;
  bool drops_velocity_;
  std::vector<std::string> notes_;
};

}  // namespace

Record consistent_record(Record record) {
  const std::vector<Line> lines = lines_of(record);
  if (lines.size() < kFewestLines) return record;
  const std::vector<Point> points = points_of(lines, kLagsOfPeriod);
  std::vector<std::string> notes;
  if (work_t(points) < -kFeeds && !is_elastic(points)) {
    record.force_sign = -1.0;
    notes.emplace_back(
        "The force as it is stored feeds the motion instead of resisting it: it is the reaction, "
        "and its sign was turned. To say so yourself: [input.scale] force_n = -1 (times a scale "
        "that is there)");
  }
  const double gain = rate_over_velocity(points_of(lines, kLagsForRate));
  const bool drops = std::abs(gain - 1.0) > kOtherScale && !is_of_a_unit(gain);
  if (drops)
    notes.push_back(fmt::format(
        "velocity_mps is the rate of deflection_m at a scale that no unit makes (1 / {:.4g}): it "
        "was not used, the velocity is derived from the deflection.",
        gain));
  if (notes.empty()) return record;
  record.notes.insert(record.notes.end(), notes.begin(), notes.end());
  record.open = [inner = record.open, sign = record.force_sign, drops,
                 notes]() -> std::unique_ptr<Source> {
    return std::make_unique<ConsistentSource>(inner(), sign, drops, notes);
  };
  return record;
}

}  // namespace dampline::app::rig
