// SPDX-License-Identifier: MIT
#include "dampline/motion/drift_free_integral.hpp"

#include <algorithm>

#include "dampline/numeric/wide.hpp"

namespace dampline {
namespace {

// Taps 0...8 of the symmetric filter: the inverse Fourier transform of 1 / (1 + (f / corner)^8),
// divided by the responses of the boxes and of the spline, under a square-root Hann window of
// half-length 9, scaled to unit sum. For a corner of 0.7 and 1.0 Hz at 300 Hz and decimation 51.
constexpr std::array<double, 9> kTaps0p7{.25912080,  .22404684,  .14146559,  .05543398, -.00141765,
                                         -.02195264, -.01840740, -.00778476, -.00094435};
constexpr std::array<double, 9> kTaps1p0{.40455557,  .29392382, .09278086, -.03250113, -.04936155,
                                         -.01865993, .00364571, .00617654, .00171789};

constexpr std::array<double, 9> unit_sum(std::array<double, 9> taps) noexcept {
  double sum = taps[0];
  for (std::size_t i = 1; i < taps.size(); ++i) sum += 2.0 * taps[i];
  for (double& tap : taps) tap /= sum;
  return taps;
}
constexpr std::array<std::array<double, 9>, 2> kTaps{unit_sum(kTaps0p7), unit_sum(kTaps1p0)};

constexpr std::array<double, 4> cubic_b_spline(double u) noexcept {
  const double r = 1.0 - u;
  return {r * r * r / 6.0, (4.0 - 6.0 * u * u + 3.0 * u * u * u) / 6.0,
          (4.0 - 6.0 * r * r + 3.0 * r * r * r) / 6.0, u * u * u / 6.0};
}

}  // namespace

Baseline::Baseline(int decimation) noexcept
    : decimation_{decimation},
      box_half_{3 * (decimation - 1) / 2},
      delay_{10 * decimation + box_half_},
      first_known_{delay_ + first()} {
  reset();
  // Box convolved with box convolved with box, by counting: how many triples of 0...decimation - 1
  // add up to i. Up to the middle there are ever more.
  const double scale = 1.0 / (static_cast<double>(decimation) * decimation * decimation);
  const auto pairs = [](int n) { return n > 0 ? n * (n + 1) / 2 : 0; };
  double sum = 0.0;
  for (int i = 0, counted = 0; i <= box_half_; ++i) {
    const int triples = pairs(i + 1) - 3 * pairs(i + 1 - decimation);
    for (; counted < triples; ++counted) sum += scale;
    box_[static_cast<std::size_t>(i)] = box_[static_cast<std::size_t>(2 * box_half_ - i)] = sum;
  }
  for (int i = 0; i < decimation; ++i) {
    spline_[static_cast<std::size_t>(i)] = cubic_b_spline(static_cast<double>(i) / decimation);
  }
}

// The sample that completes the boxes of an instant also begins a stretch of the spline: the value
// that comes out with it lies on a knot, two instants before the newest coefficient.
void Baseline::low_rate_step() noexcept {
  const std::int64_t instant = instant_++;
  next_box_ += decimation_;
  place_ = 0;
  const std::int64_t start = instant * decimation_ - box_half_;
  const auto length = static_cast<std::size_t>(2 * box_half_ + 1);
  const std::size_t from = static_cast<std::size_t>(start) & (kRing - 1);
  const std::size_t before_end = std::min(length, kRing - from);
  low_[static_cast<std::size_t>(instant) & 31U] =
      wide_dot(box_.data(), &ring_[from], before_end) +
      wide_dot(box_.data() + before_end, ring_.data(), length - before_end);
  const std::int64_t centre = instant - kTapsHalf;
  if (centre < kFirstBox + kTapsHalf) return;
  const auto& taps = kTaps[static_cast<std::size_t>(corner_)];
  const auto low = [this](std::int64_t i) { return low_[static_cast<std::size_t>(i) & 31U]; };
  double c = taps[0] * low(centre);
  for (int j = 1; j <= kTapsHalf; ++j) {
    c += taps[static_cast<std::size_t>(j)] * (low(centre - j) + low(centre + j));
  }
  knots_ = {knots_[1], knots_[2], knots_[3], c};
}

void Baseline::rebase(double amount) noexcept {
  for (double& x : ring_) x -= amount;
  for (double& x : low_) x -= amount;
  for (double& x : knots_) x -= amount;
}

}  // namespace dampline
