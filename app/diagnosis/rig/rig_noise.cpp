// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/rig_noise.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dampline::app {
namespace {

constexpr int kParts = 12;
constexpr int kClasses = 5;
constexpr double kGaussian = 0.4;  // of the kurtosis, either way
constexpr double kSteady = 1.8;
constexpr double kUnmoved = 1.4;
constexpr std::size_t kFewest = 500;

/// Samples whose sign of v is certain and which took part in the fit.
std::vector<Eigen::Index> certain(const RigSeries& record) {
  const Eigen::Index near = reach_of_reversal(record);
  std::vector<Eigen::Index> out;
  Eigen::Index turned = -near - 1;
  for (Eigen::Index i = 1; i < record.size(); ++i) {
    if (record.velocity_mps[i] * record.velocity_mps[i - 1] <= 0.0) {
      turned = i;
      while (!out.empty() && out.back() >= i - near) out.pop_back();
    }
    const bool left_out = record.left_out.size() == record.size() && record.left_out[i] > 0.0;
    if (i > turned + near && !left_out) out.push_back(i);
  }
  return out;
}

Eigen::VectorXd travel_since_reversal(const RigSeries& record) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(record.size());
  for (Eigen::Index i = 1; i < record.size(); ++i) {
    const bool turned = record.velocity_mps[i] * record.velocity_mps[i - 1] <= 0.0;
    const double step_m = std::abs(record.deflection_m[i] - record.deflection_m[i - 1]);
    out[i] = turned ? 0.0 : out[i - 1] + step_m;
  }
  return out;
}

double ratio_of(const std::vector<double>& power) {
  const auto [low, high] = std::minmax_element(power.begin(), power.end());
  return *low > 0.0 ? *high / *low : 1e9;
}

/// Loudest over quietest of as many equal parts, in the order of `by`.
double spread(const Eigen::VectorXd& left, const Eigen::VectorXd& by, int parts) {
  std::vector<std::pair<double, double>> sorted;
  for (Eigen::Index i = 0; i < left.size(); ++i) sorted.emplace_back(by[i], left[i] * left[i]);
  std::sort(sorted.begin(), sorted.end());
  std::vector<double> power(static_cast<std::size_t>(parts), 0.0);
  for (std::size_t i = 0; i < sorted.size(); ++i)
    power[i * power.size() / sorted.size()] += sorted[i].second;
  return ratio_of(power);
}

}  // namespace

bool RigLeft::is_like_noise() const noexcept {
  return std::abs(kurtosis - 3.0) < kGaussian && over_time < kSteady && over_speed < kUnmoved &&
         over_reversal < kUnmoved;
}

RigLeft what_is_left(const std::vector<RigSeries>& records, const RigModel& model) {
  RigLeft out;
  double squares = 0.0;
  double fourths = 0.0;
  double count = 0.0;
  for (const RigSeries& record : records) {
    const std::vector<Eigen::Index> rows = certain(record);
    if (rows.size() < kFewest) return {};
    const Eigen::VectorXd left = left_of(record, model.columns, model.fit.theta)(rows);
    const Eigen::VectorXd order = Eigen::VectorXd::LinSpaced(left.size(), 0.0, 1.0);
    const Eigen::VectorXd speed = record.velocity_mps.cwiseAbs()(rows);
    const Eigen::VectorXd travel = travel_since_reversal(record)(rows);
    out.over_time = std::max(out.over_time, spread(left, order, kParts));
    out.over_speed = std::max(out.over_speed, spread(left, speed, kClasses));
    out.over_reversal = std::max(out.over_reversal, spread(left, travel, kClasses));
    const double variance = (record.force_n.array() - record.force_n.mean()).square().mean();
    out.nmse += left.squaredNorm() / static_cast<double>(left.size()) / variance /
                static_cast<double>(records.size());
    squares += left.squaredNorm();
    fourths += left.array().square().square().sum();
    count += static_cast<double>(left.size());
  }
  out.rms_n = std::sqrt(squares / count);
  out.kurtosis = squares > 0.0 ? fourths * count / (squares * squares) : 0.0;
  return out;
}

}  // namespace dampline::app
