// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/regressor.hpp"

#include <algorithm>
#include <cmath>

#include "app/beside.hpp"
#include "app/diagnosis/rig/trials.hpp"
#include "dampline/rig/columns.hpp"

namespace dampline::app::rig {
namespace {

/// z' = v - z / a, exact where the deflection is straight between samples.
Eigen::VectorXd maxwell(const Eigen::VectorXd& deflection_m, double time_s, double interval_s) {
  const double kept = std::exp(-interval_s / time_s);
  const double gained = time_s / interval_s * (1.0 - kept);
  Eigen::VectorXd out = Eigen::VectorXd::Zero(deflection_m.size());
  for (Eigen::Index i = 1; i < out.size(); ++i)
    out[i] = kept * out[i - 1] + gained * (deflection_m[i] - deflection_m[i - 1]);
  return out;
}

Eigen::VectorXd steady(const Regressor& column, const Series& series) {
  const Eigen::Index count = series.size();
  if (column.kind == Kind::kAttached)
    return attached_accel(series.deflection_m, series.velocity_mps, {column.a, column.b},
                          series.interval_s);
  if (column.kind == Kind::kMaxwell)
    return maxwell(series.deflection_m, column.a, series.interval_s);
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
    if (!law::has_stop(column.kind)) {
      out[i] = law::value_at(column, x, v);
      continue;
    }
    const double step_m = i > 0 ? x - series.deflection_m[i - 1] : 0.0;
    z_m = std::clamp(z_m + step_m, -column.a, column.a);
    slip_m = std::abs(z_m) >= column.a ? slip_m + std::abs(step_m) : 0.0;
    out[i] = law::memory_at(column, z_m / column.a, v, slip_m);
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

Rows rows_of(const std::vector<Regressor>& columns, const Series& series, Eigen::Index stride,
             bool filtered) {
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
  const auto fill = [&](std::size_t place) {
    const auto c = static_cast<Eigen::Index>(place);
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
  };
  each_of_values(series.size() * count, static_cast<std::size_t>(count + 1), fill);
  return out;
}

}  // namespace dampline::app::rig
