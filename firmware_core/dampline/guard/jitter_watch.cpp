// SPDX-License-Identifier: MIT
#include "dampline/guard/jitter_watch.hpp"

#include <algorithm>
#include <cmath>

#include "dampline/numeric/cholesky.hpp"

namespace dampline {
namespace {

constexpr std::size_t kJitterBlocks = 6;   // that tell
constexpr double kJitterSure = 8.0;        // deviations; records without jitter reach 1.6
constexpr double kLeastJitterS = 5e-5;     // rms
constexpr double kFewestCompared = 300.0;  // samples of a block

}  // namespace

void JitterWatch::Chunk::add(const Chunk& o) noexcept {
  samples += o.samples;
  aa += o.aa;
  dd += o.dd;
  ad += o.ad;
  ae += o.ae;
  de += o.de;
  ee += o.ee;
  aaaa += o.aaaa;
  aadd += o.aadd;
  dddd += o.dddd;
  aaee += o.aaee;
  ddee += o.ddee;
}

void JitterWatch::update(double a, double d, double difference) noexcept {
  const double rest = difference - gain_ * a - delay_ * d;
  const double aa = a * a;
  const double dd = d * d;
  const double ee = rest * rest;
  chunk_.samples += 1.0;
  chunk_.aa += aa;
  chunk_.dd += dd;
  chunk_.ad += a * d;
  chunk_.ae += a * difference;
  chunk_.de += d * difference;
  chunk_.ee += ee;
  chunk_.aaaa += aa * aa;
  chunk_.aadd += aa * dd;
  chunk_.dddd += dd * dd;
  chunk_.aaee += aa * ee;
  chunk_.ddee += dd * ee;
}

void JitterWatch::end_chunk(bool sound) noexcept {
  if (sound) block_.add(chunk_);
  chunk_ = {};
}

void JitterWatch::close_block(bool sound, std::int64_t tick, FaultLog& log) noexcept {
  const Chunk b = block_;
  block_ = {};
  if (!sound || b.samples < kFewestCompared) return;
  const double determinant = b.aa * b.dd - b.ad * b.ad;
  if (!(determinant > 0.0)) return;
  gain_ = (b.dd * b.ae - b.ad * b.de) / determinant;
  delay_ = (b.aa * b.de - b.ad * b.ae) / determinant;
  using Square = Eigen::Matrix<double, 3, 3>;
  using Column = Eigen::Matrix<double, 3, 1>;
  const double w2 = b.dd / b.aa;  // per sample^2
  Square normal;
  normal << b.samples, b.dd / w2, b.aa, b.dd / w2, b.dddd / (w2 * w2), b.aadd / w2, b.aa,
      b.aadd / w2, b.aaaa;
  const Column c = solve_cholesky<3>(normal, Column{b.ee, b.ddee / w2, b.aaee});
  if (!std::isfinite(c[1])) return;
  variance_.add(0.5 * (c[1] - c[2]) / w2, tick);
  const double usual = variance_.median();
  if (variance_.size() < kJitterBlocks || !(usual > 0.0)) return;
  const double deviation = variance_.scatter() / std::sqrt(static_cast<double>(variance_.size()));
  const double rms_s = std::sqrt(usual) / rate_hz_;
  if (usual < kJitterSure * deviation || rms_s < kLeastJitterS) return;
  log.report(FaultKind::kJitter, FaultChannel::kWheelsets, log.seconds(tick), rms_s);
}

}  // namespace dampline
