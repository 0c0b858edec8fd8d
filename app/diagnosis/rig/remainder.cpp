// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/remainder.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace dampline::app::rig {
namespace {

constexpr int kParts = 12;
constexpr int kClasses = 5;
constexpr double kGaussian = 0.4;  // of the kurtosis, either way
constexpr double kSteadyLoudness = 1.8;
constexpr double kUnmoved = 1.4;
constexpr std::size_t kFewestCertain = 500;

/// Samples whose sign of v is certain and which took part in the fit.
std::vector<Eigen::Index> certain(const Series& record) {
  const Eigen::Index near = reach_of_reversal(record);
  std::vector<Eigen::Index> out;
  Eigen::Index turned = -near - 1;
  for (Eigen::Index i = 1; i < record.size(); ++i) {
    if (record.velocity_mps[i] * record.velocity_mps[i - 1] <= 0.0) {
      turned = i;
      while (!out.empty() && out.back() >= i - near) out.pop_back();
    }
    if (i > turned + near && record.why_left_out(i) == 0.0) out.push_back(i);
  }
  return out;
}

Eigen::VectorXd travel_since_reversal(const Series& record) {
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

constexpr double kReachS = 0.025;  // about an impact
constexpr Eigen::Index kLeastReach = 4;
constexpr double kPeak = 8.0;        // of the scatter
constexpr double kMostShare = 0.15;  // of the time
constexpr int kBins = 9;             // of deflection and of velocity, each
constexpr double kOftenAt = 0.35;    // of the passes through a bin: the motion makes the peak
constexpr int kFewestPasses = 3;
constexpr double kUnannounced = 0.7;  // of the peaks

/// What stands out of the median about each sample.
Eigen::VectorXd sharp_part(const Eigen::VectorXd& left_n, Eigen::Index reach) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(left_n.size());
  for (Eigen::Index i = reach; i + reach < left_n.size(); ++i) {
    std::vector<double> about{left_n.data() + i - reach, left_n.data() + i + reach + 1};
    out[i] = left_n[i] - median_of(about);
  }
  return out;
}

double scatter_of(const Eigen::VectorXd& values) {
  std::vector<double> size;
  for (const double v : values) size.push_back(std::abs(v));
  return 1.4826 * median_of(size);
}

struct Peak {
  Eigen::Index at;
  double size_n;
};

std::vector<Peak> peaks_of(const Eigen::VectorXd& sharp, Eigen::Index reach) {
  const double least = kPeak * scatter_of(sharp);
  std::vector<Peak> out;
  for (Eigen::Index i = 0; i < sharp.size(); ++i) {
    const double size = std::abs(sharp[i]);
    if (!(size > least)) continue;
    if (out.empty() || i - out.back().at > 2 * reach)
      out.push_back({i, size});
    else if (size > out.back().size_n)
      out.back() = {i, size};
  }
  return out;
}

int bin_of(double value, double scale) {
  return std::clamp(static_cast<int>(std::floor((value / scale + 1.0) * 0.5 * kBins)), 0,
                    kBins - 1);
}

bool is_near_reversal(const Series& record, Eigen::Index at) {
  const Eigen::Index near = reach_of_reversal(record);
  const Eigen::Index from = std::max<Eigen::Index>(at - near, 0);
  const Eigen::Index to = std::min(at + near, record.size() - 1);
  const auto part = record.velocity_mps.segment(from, to - from + 1);
  return part.minCoeff() <= 0.0 && part.maxCoeff() >= 0.0;
}

using Cell = std::pair<int, int>;

Cell state_at(const Series& record, Eigen::Index i, double x_m, double v_mps) {
  return {bin_of(record.deflection_m[i], x_m), bin_of(record.velocity_mps[i], v_mps)};
}

/// The peaks in states that are passed without one most of the time.
std::vector<Peak> unannounced(const Series& record, const std::vector<Peak>& peaks) {
  const double x_m = 2.0 * std::sqrt(record.deflection_m.array().square().mean());
  const double v_mps = 2.0 * std::sqrt(record.velocity_mps.array().square().mean());
  std::map<Cell, int> passes;
  std::map<Cell, int> hits;
  Cell last{-1, -1};
  for (Eigen::Index i = 0; i < record.size(); ++i) {
    const Cell now = state_at(record, i, x_m, v_mps);
    if (now != last) ++passes[now];
    last = now;
  }
  for (const Peak& p : peaks) ++hits[state_at(record, p.at, x_m, v_mps)];
  std::vector<Peak> out;
  for (const Peak& p : peaks) {
    const Cell state = state_at(record, p.at, x_m, v_mps);
    const int all = passes[state];
    if (all >= kFewestPasses && hits[state] < kOftenAt * all) out.push_back(p);
  }
  return out;
}

}  // namespace

bool Remainder::is_like_noise() const noexcept {
  return std::abs(kurtosis - 3.0) < kGaussian && over_time < kSteadyLoudness &&
         over_speed < kUnmoved && over_reversal < kUnmoved;
}

Remainder what_is_left(const std::vector<Series>& records, const Model& model) {
  Remainder out;
  double squares = 0.0;
  double fourths = 0.0;
  double count = 0.0;
  for (const Series& record : records) {
    const std::vector<Eigen::Index> rows = certain(record);
    if (rows.size() < kFewestCertain) return {};
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

Impacts find_impacts(const std::vector<Series>& records,
                     const std::vector<Eigen::VectorXd>& left_n) {
  Impacts out;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const Series& record = records[r];
    out.left_out.push_back(record.left_out.size() == record.size()
                               ? record.left_out
                               : Eigen::VectorXd::Zero(record.size()));
    if (kReachS < 3.0 * record.interval_s) continue;  // not seen apart from a reversal
    const auto reach =
        std::max(kLeastReach, static_cast<Eigen::Index>(kReachS / record.interval_s));
    std::vector<Peak> peaks = peaks_of(sharp_part(left_n[r], reach), reach);
    std::erase_if(peaks, [&](const Peak& p) {
      return is_near_reversal(record, p.at) || record.why_left_out(p.at) != 0.0;
    });
    const double share = 2.0 * static_cast<double>(reach) * static_cast<double>(peaks.size()) /
                         static_cast<double>(record.size());
    const std::vector<Peak> alone = unannounced(record, peaks);
    if (share > kMostShare ||
        static_cast<double>(alone.size()) < kUnannounced * static_cast<double>(peaks.size()))
      continue;
    for (const Peak& p : alone) {
      const Eigen::Index from = std::max<Eigen::Index>(p.at - reach, 0);
      const Eigen::Index to = std::min(p.at + reach + 1, record.size());
      out.left_out.back().segment(from, to - from).setConstant(Series::kImpact);
      out.time_s.push_back(record.time_s[p.at]);
      out.peak_n.push_back(p.size_n);
    }
  }
  return out;
}

}  // namespace dampline::app::rig
