// SPDX-License-Identifier: MIT
#include "dampline/guard/jitter_watch.hpp"

#include <algorithm>
#include <cmath>

#include "dampline/numeric/cholesky.hpp"

namespace dampline {
namespace {

constexpr std::size_t kJitterBlocks = 6;   // that tell
constexpr double kJitterSure = 6.0;        // deviations; records without jitter reach 4
constexpr int kSureBlocks = 2;             // in a row
constexpr double kLeastJitterS = 5e-5;     // rms
constexpr double kFewestCompared = 300.0;  // samples of a block

}  // namespace

void JitterWatch::update(double a, double d, double f) noexcept {
  const double e = f - gain_ * a - delay_ * d;
  const double aa = a * a;
  const double dd = d * d;
  const double ee = e * e;
  chunk_ +=
      Sums{{1.0, aa, dd, a * d, a * f, d * f, ee, aa * aa, aa * dd, dd * dd, aa * ee, dd * ee}};
}

void JitterWatch::end_chunk(bool sound) noexcept {
  if (sound) block_ += chunk_;
  chunk_ = Sums::Zero();
}

void JitterWatch::close_block(bool sound, std::int64_t tick, FaultLog& log) noexcept {
  const Sums b = block_;
  block_ = Sums::Zero();
  if (!sound || b[kSamples] < kFewestCompared) return;
  const double determinant = b[kAA] * b[kDD] - b[kAD] * b[kAD];
  if (!(determinant > 0.0)) return;
  gain_ = (b[kDD] * b[kAF] - b[kAD] * b[kDF]) / determinant;
  delay_ = (b[kAA] * b[kDF] - b[kAD] * b[kAF]) / determinant;
  using Square = Eigen::Matrix<double, 3, 3>;
  using Column = Eigen::Matrix<double, 3, 1>;
  const double w2 = b[kDD] / b[kAA];  // per sample^2
  Square normal;
  normal << b[kSamples], b[kDD] / w2, b[kAA], b[kDD] / w2, b[kDDDD] / (w2 * w2), b[kAADD] / w2,
      b[kAA], b[kAADD] / w2, b[kAAAA];
  const Column c = solve_cholesky<3>(normal, Column{b[kEE], b[kDDEE] / w2, b[kAAEE]});
  if (!std::isfinite(c[1])) return;
  variance_.add(0.5 * (c[1] - c[2]) / w2, tick);
  const double usual = variance_.median();
  if (variance_.size() < kJitterBlocks || !(usual > 0.0)) return;
  const auto blocks = static_cast<double>(variance_.size());
  // The scatter of a few blocks is hardly known: twice as much of six, as it is of many.
  const double doubt = 1.0 + static_cast<double>(kJitterBlocks) / blocks;
  const double deviation = doubt * variance_.scatter() / std::sqrt(blocks);
  const double rms_s = std::sqrt(usual) / rate_hz_;
  const bool sure = usual >= kJitterSure * deviation && rms_s >= kLeastJitterS;
  sure_blocks_ = sure ? sure_blocks_ + 1 : 0;
  if (sure_blocks_ < kSureBlocks) return;
  log.report(FaultKind::kJitter, FaultChannel::kWheelsets, log.seconds(tick), rms_s);
}

}  // namespace dampline
