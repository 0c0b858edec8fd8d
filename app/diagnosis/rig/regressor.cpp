// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/regressor.hpp"

#include <algorithm>
#include <cmath>

#include "app/diagnosis/rig/trials.hpp"
#include "dampline/rig/columns.hpp"

namespace dampline::app::rig {
namespace {

constexpr double kBreakawayM = 0.010;
constexpr double kEdgeFrom = 0.9;

double hat(double u, double node) {
  const double width = 2.0 / (Regressor::kHats - 1);
  const double centre = -1.0 + width * node;
  return std::max(0.0, 1.0 - std::abs(u - centre) / width);
}

/// tanh, which is slow and mostly 1.
double softened_sign(double u) {
  constexpr double kOne = 19.1;  // beyond it tanh is 1 in double precision
  return std::abs(u) > kOne ? std::copysign(1.0, u) : std::tanh(u);
}

bool has_memory(Kind kind) { return kind >= Kind::kStop; }

double static_value(const Regressor& c, double x, double v) {
  switch (c.kind) {
    case Kind::kInertia:
    case Kind::kDeflection:
      return x;
    case Kind::kSquare:
      return x * x;
    case Kind::kCube:
      return x * x * x;
    case Kind::kMagnitude:
      return std::abs(x);
    case Kind::kBumpUp:
      return std::max(x - c.a, 0.0);
    case Kind::kBumpDown:
      return std::min(x + c.a, 0.0);
    case Kind::kVelocity:
      return v;
    case Kind::kSpeed:
      return std::abs(v);
    case Kind::kSpeedSquared:
      return v * std::abs(v);
    case Kind::kSign:
      return softened_sign(v / c.a);
    case Kind::kFading:
      return softened_sign(v / c.a) * std::exp(-std::abs(v) / c.b);
    case Kind::kFadingSquare:
      return softened_sign(v / c.a) * std::exp(-v * v / (c.b * c.b));
    case Kind::kFadingSlowly:
      return softened_sign(v / c.a) / (1.0 + v * v / (c.b * c.b));
    case Kind::kProgressive:
      return softened_sign(v / c.a) * x;
    case Kind::kProgressiveAbsolute:
      return softened_sign(v / c.a) * std::abs(x);
    default:
      return 1.0;
  }
}

double memory_value(const Regressor& c, double u, double v, double slip_m) {
  switch (c.kind) {
    case Kind::kStop:
      return u;
    case Kind::kGapUp:
      return std::pow(std::max(u, 0.0), 4);
    case Kind::kGapDown:
      return -std::pow(std::max(-u, 0.0), 4);
    case Kind::kEdge:
      return std::copysign(std::max(0.0, (std::abs(u) - kEdgeFrom) / (1.0 - kEdgeFrom)), u);
    case Kind::kHat:
      return hat(u, c.b);
    case Kind::kFall:
      return std::abs(v) * std::clamp(2.0 * c.b * u - 1.0, 0.0, 1.0);
    default:
      return c.b * u >= 1.0 ? std::abs(v) * std::exp(-slip_m / kBreakawayM) : 0.0;
  }
}

Eigen::VectorXd steady(const Regressor& column, const Series& series) {
  const Eigen::Index count = series.size();
  if (column.kind == Kind::kAttached)
    return attached_accel(series.deflection_m, series.velocity_mps, {column.a, column.b},
                          series.interval_s);
  if (column.kind == Kind::kBoucWen) return bouc_wen(series.deflection_m, column.a, column.b);
  Eigen::VectorXd out{count};
  double z_m = std::clamp(series.start_m, -column.a, column.a);
  double slip_m = 0.0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const double x = series.deflection_m[i];
    const double v = series.velocity_mps[i];
    if (column.kind == Kind::kAcceleration) {
      const Eigen::Index from = std::max<Eigen::Index>(i - 1, 0);
      const Eigen::Index to = std::min<Eigen::Index>(i + 1, count - 1);
      out[i] = (series.velocity_mps[to] - series.velocity_mps[from]) /
               (static_cast<double>(to - from) * series.interval_s);
      continue;
    }
    if (!has_memory(column.kind)) {
      out[i] = static_value(column, x, v);
      continue;
    }
    const double step_m = i > 0 ? x - series.deflection_m[i - 1] : 0.0;
    z_m = std::clamp(z_m + step_m, -column.a, column.a);
    slip_m = std::abs(z_m) >= column.a ? slip_m + std::abs(step_m) : 0.0;
    out[i] = memory_value(column, z_m / column.a, v, slip_m);
  }
  return out;
}

void change_over_time(const Regressor& column, Eigen::VectorXd& values) {
  const bool slope = column.time == Regressor::Time::kSlope;
  const double whole = static_cast<double>(std::max<Eigen::Index>(values.size() - 1, 1));
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const double share = static_cast<double>(i) / whole;
    values[i] *= slope ? share - 0.5 : static_cast<double>(share > column.at);
  }
}

}  // namespace

bool is_filtered(const std::vector<Regressor>& columns) noexcept {
  return std::any_of(columns.begin(), columns.end(),
                     [](const Regressor& c) { return c.kind == Kind::kInertia; });
}

Eigen::VectorXd evaluate(const Regressor& column, const Series& series) {
  Eigen::VectorXd out = steady(column, series);
  if (column.time != Regressor::Time::kSteady) change_over_time(column, out);
  return through_mode(out, series.path, series.interval_s);
}

Eigen::VectorXd left_of(const Series& series, const std::vector<Regressor>& columns,
                        const Eigen::VectorXd& theta) {
  Eigen::VectorXd out = series.force_n;
  for (std::size_t c = 0; c < columns.size(); ++c)
    out -= theta[static_cast<Eigen::Index>(c)] * evaluate(columns[c], series);
  return out;
}

Rows rows_of(const std::vector<Regressor>& columns, const Series& series, Eigen::Index stride) {
  const bool filtered = is_filtered(columns);
  const int half = filtered ? core::half_support_samples(series.config) : 0;
  const core::TestFunction window{std::max(half, core::TestFunction::kDifference + 1),
                                  series.interval_s};
  const Eigen::Index reach = filtered ? window.half() : 0;
  Rows out;
  for (Eigen::Index i = reach; i + reach < series.size(); i += stride) out.sample.push_back(i);
  const auto rows = static_cast<Eigen::Index>(out.sample.size());
  const auto count = static_cast<Eigen::Index>(columns.size());
  out.values.resize(rows, count + 1);
  Eigen::VectorXd psi{2 * reach + 1};
  Eigen::VectorXd rate{2 * reach + 1};
  Eigen::VectorXd second{2 * reach + 1};
  for (Eigen::Index j = -reach; filtered && j <= reach; ++j) {
    const core::TestFunction::Values values = window.at(static_cast<int>(j));
    psi[reach + j] = values.psi;
    rate[reach + j] = -values.first;
    second[reach + j] = values.second;
  }
  if (!filtered) psi[0] = 1.0;
  const double sum = psi.sum();
  psi /= sum;
  rate /= sum;
  second /= sum;
  const bool derived = filtered && !series.config.velocity_measured;
  for (Eigen::Index c = 0; c <= count; ++c) {
    const bool force = c == count;
    Regressor column = force ? Regressor{} : columns[static_cast<std::size_t>(c)];
    const bool rates = derived && !force && column.kind == Kind::kVelocity &&
                       column.time == Regressor::Time::kSteady;
    if (rates) column.kind = Kind::kDeflection;
    const Eigen::VectorXd& weights = rates ? rate : column.kind == Kind::kInertia ? second : psi;
    const Eigen::VectorXd values = force ? series.force_n : evaluate(column, series);
    for (Eigen::Index r = 0; r < rows; ++r) {
      const Eigen::Index centre = out.sample[static_cast<std::size_t>(r)];
      out.values(r, c) = weights.dot(values.segment(centre - reach, 2 * reach + 1));
    }
  }
  return out;
}

}  // namespace dampline::app::rig
