// SPDX-License-Identifier: MIT
#include "dampline/phase/period.hpp"

#include <algorithm>
#include <cmath>

namespace dampline {
namespace {

constexpr int kShortestLags = 4;         // periods below this many lags are not resolved
constexpr int kLeastMultiples = 4;       // fewer cannot tell a period from a decaying memory
constexpr double kAlmostHighest = 0.85;  // a peak this high beside the highest is a period itself
constexpr double kLeastPersistence = 0.8;
constexpr double kLeastHeight = 0.1;
constexpr double kLeastSigmas = 3.0;
constexpr double kNearby = 0.03;  // of a period that is said to be there

struct Correlation {
  const double* r;
  int lags;
  [[nodiscard]] bool is_peak(int l) const noexcept {
    return l > 0 && l + 1 < lags && r[l] >= r[l - 1] && r[l] > r[l + 1];
  }
};

/// A maximum between lags: place in lags and height of the parabola through three values.
struct Peak {
  double place{0.0};
  double height{0.0};
};

Peak refine(const Correlation& c, int l) noexcept {
  const double slope = 0.5 * (c.r[l + 1] - c.r[l - 1]);
  const double bend = c.r[l + 1] - 2.0 * c.r[l] + c.r[l - 1];
  if (!(bend < 0.0)) return {static_cast<double>(l), c.r[l]};
  const double shift = std::clamp(-slope / bend, -1.0, 1.0);
  return {l + shift, c.r[l] + 0.5 * slope * shift};
}

/// The highest peak within `reach` of a place; height -1 without one.
Peak peak_near(const Correlation& c, double place, double reach) noexcept {
  Peak best{place, -1.0};
  const int first = std::max(1, static_cast<int>(std::ceil(place - reach)));
  const int last = std::min(c.lags - 2, static_cast<int>(std::floor(place + reach)));
  for (int l = first; l <= last; ++l) {
    if (!c.is_peak(l)) continue;
    const Peak peak = refine(c, l);
    if (peak.height > best.height) best = peak;
  }
  return best;
}

/// The first peak that is almost as high as the highest, beyond the first change of sign.
Peak first_high_peak(const Correlation& c) noexcept {
  int start = 1;
  while (start < c.lags && c.r[start] > 0.0) ++start;
  start = std::max(start, kShortestLags);
  const int end = c.lags / kLeastMultiples;
  double highest = 0.0;
  for (int l = start; l < end; ++l)
    if (c.is_peak(l)) highest = std::max(highest, c.r[l]);
  for (int l = start; l < end; ++l)
    if (c.is_peak(l) && c.r[l] >= kAlmostHighest * highest) return refine(c, l);
  return {};
}

/// Peaks at the multiples of a period.
struct Comb {
  double period{0.0};
  double period_std{0.0};
  int multiples{0};
  double near{0.0};  ///< mean height of the first half
  double far{0.0};   ///< mean height of the second half
};

/// Follows the multiples outward; the period is the slope of the peaks' places over their number.
Comb follow(const Correlation& c, const Peak& first) noexcept {
  const int multiples = static_cast<int>((c.lags - 2) / first.place);
  double sum_mp = 0.0;
  double sum_mm = 0.0;
  double sum_pp = 0.0;
  Comb comb{.period = first.place, .multiples = multiples};
  const int half = multiples / 2;
  for (int m = 1; m <= multiples; ++m) {
    const Peak peak = peak_near(c, m * comb.period, 0.25 * first.place);
    (m <= half ? comb.near : comb.far) += std::max(peak.height, 0.0);
    if (peak.height < 0.0) continue;
    sum_mp += m * peak.place;
    sum_mm += static_cast<double>(m) * m;
    sum_pp += peak.place * peak.place;
    comb.period = sum_mp / sum_mm;
  }
  comb.near /= half;
  comb.far /= multiples - half;
  const double left = std::max(sum_pp - sum_mp * comb.period, 0.0) / (multiples - 1);
  // Neighbouring peaks err together: only about two of the places are independent.
  comb.period_std = std::sqrt(left / sum_mm * 0.5 * multiples);
  return comb;
}

/// Bartlett: variance of an estimated autocorrelation beyond the signal's memory.
double far_variance(const Correlation& c, std::uint64_t pairs) noexcept {
  double sum = 1.0;
  for (int l = 1; l < c.lags; ++l) sum += 2.0 * c.r[l] * c.r[l];
  return sum / static_cast<double>(pairs);
}

Period judge(const Correlation& c, const Peak& first, std::uint64_t pairs, double lag_s) noexcept {
  Period out{.state = PeriodState::kNone};
  if (!(first.height > 0.0)) return out;
  const Comb comb = follow(c, first);
  out.height = comb.far;
  out.persistence = comb.near > 0.0 ? std::min(comb.far / comb.near, 1.0) : 0.0;
  const double z2 = comb.far * comb.far / far_variance(c, pairs);
  out.confidence = out.persistence * (1.0 - std::exp(-0.5 * z2));
  if (out.persistence < kLeastPersistence || comb.far < kLeastHeight ||
      z2 < kLeastSigmas * kLeastSigmas)
    return out;
  out.state = PeriodState::kFound;
  out.period_s = comb.period * lag_s;
  out.period_std_s = comb.period_std * lag_s;
  return out;
}

}  // namespace

Period find_period(const double* correlation, int lags, std::uint64_t pairs,
                   double lag_s) noexcept {
  const Correlation c{correlation, lags};
  return judge(c, first_high_peak(c), pairs, lag_s);
}

Period confirm_period(const double* correlation, int lags, std::uint64_t pairs, double lag_s,
                      double period_s) noexcept {
  const Correlation c{correlation, lags};
  const double place = period_s / lag_s;
  if (!(place >= kShortestLags) || place * kLeastMultiples > lags - 2) return {};
  return judge(c, peak_near(c, place, std::max(1.0, kNearby * place)), pairs, lag_s);
}

}  // namespace dampline
