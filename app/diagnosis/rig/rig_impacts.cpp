// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/rig_impacts.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace dampline::app {
namespace {

constexpr double kReachS = 0.025;  // about an impact
constexpr Eigen::Index kLeastReach = 4;
constexpr double kPeak = 8.0;        // of the scatter
constexpr double kMostShare = 0.15;  // of the time
constexpr int kBins = 9;             // of deflection and of velocity, each
constexpr double kOftenAt = 0.35;    // of the passes through a bin: the motion makes the peak
constexpr int kFewestPasses = 3;
constexpr double kUnannounced = 0.7;  // of the peaks

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// What stands out of the median about each sample.
Eigen::VectorXd sharp_part(const Eigen::VectorXd& left_n, Eigen::Index reach) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(left_n.size());
  for (Eigen::Index i = reach; i + reach < left_n.size(); ++i)
    out[i] = left_n[i] - median({left_n.data() + i - reach, left_n.data() + i + reach + 1});
  return out;
}

double scatter_of(const Eigen::VectorXd& values) {
  std::vector<double> size;
  for (const double v : values) size.push_back(std::abs(v));
  return 1.4826 * median(std::move(size));
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

bool is_near_reversal(const RigSeries& record, Eigen::Index at) {
  const Eigen::Index near = reach_of_reversal(record);
  const Eigen::Index from = std::max<Eigen::Index>(at - near, 0);
  const Eigen::Index to = std::min(at + near, record.size() - 1);
  const auto part = record.velocity_mps.segment(from, to - from + 1);
  return part.minCoeff() <= 0.0 && part.maxCoeff() >= 0.0;
}

using State = std::pair<int, int>;

State state_at(const RigSeries& record, Eigen::Index i, double x_m, double v_mps) {
  return {bin_of(record.deflection_m[i], x_m), bin_of(record.velocity_mps[i], v_mps)};
}

/// The peaks in states that are passed without one most of the time.
std::vector<Peak> unannounced(const RigSeries& record, const std::vector<Peak>& peaks) {
  const double x_m = 2.0 * std::sqrt(record.deflection_m.array().square().mean());
  const double v_mps = 2.0 * std::sqrt(record.velocity_mps.array().square().mean());
  std::map<State, int> passes;
  std::map<State, int> hits;
  State last{-1, -1};
  for (Eigen::Index i = 0; i < record.size(); ++i) {
    const State now = state_at(record, i, x_m, v_mps);
    if (now != last) ++passes[now];
    last = now;
  }
  for (const Peak& p : peaks) ++hits[state_at(record, p.at, x_m, v_mps)];
  std::vector<Peak> out;
  for (const Peak& p : peaks) {
    const State state = state_at(record, p.at, x_m, v_mps);
    const int all = passes[state];
    if (all >= kFewestPasses && hits[state] < kOftenAt * all) out.push_back(p);
  }
  return out;
}

}  // namespace

RigImpacts find_impacts(const std::vector<RigSeries>& records,
                        const std::vector<Eigen::VectorXd>& left_n) {
  RigImpacts out;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const RigSeries& record = records[r];
    out.left_out.emplace_back(Eigen::VectorXd::Zero(record.size()));
    if (kReachS < 3.0 * record.interval_s) continue;  // not seen apart from a reversal
    const auto reach =
        std::max(kLeastReach, static_cast<Eigen::Index>(kReachS / record.interval_s));
    std::vector<Peak> peaks = peaks_of(sharp_part(left_n[r], reach), reach);
    std::erase_if(peaks, [&](const Peak& p) { return is_near_reversal(record, p.at); });
    const double share = 2.0 * static_cast<double>(reach) * static_cast<double>(peaks.size()) /
                         static_cast<double>(record.size());
    const std::vector<Peak> alone = unannounced(record, peaks);
    if (share > kMostShare ||
        static_cast<double>(alone.size()) < kUnannounced * static_cast<double>(peaks.size()))
      continue;
    for (const Peak& p : alone) {
      const Eigen::Index from = std::max<Eigen::Index>(p.at - reach, 0);
      const Eigen::Index to = std::min(p.at + reach + 1, record.size());
      out.left_out.back().segment(from, to - from).setOnes();
      out.time_s.push_back(record.time_s[p.at]);
      out.peak_n.push_back(p.size_n);
    }
  }
  return out;
}

}  // namespace dampline::app
