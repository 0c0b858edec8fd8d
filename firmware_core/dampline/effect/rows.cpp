// SPDX-License-Identifier: MIT
#include "dampline/effect/rows.hpp"

#include <array>
#include <cmath>
#include <span>

#include "dampline/numeric/wide.hpp"

namespace dampline::effect {
namespace {

/// Fifth derivative of (1 - u^2)^8 at u = n / reach, zero beyond the ends.
double fifth(int n, int reach) noexcept {
  if (n <= -reach || n >= reach) return 0.0;
  const double u = static_cast<double>(n) / reach;
  const double u2 = u * u;
  const double q = 1.0 - u2;
  const double inner = -8.0 * (1.0 - 26.0 * u2 + 65.0 * u2 * u2) + q * (-52.0 + 260.0 * u2);
  return 672.0 * u * q * q * q * inner;
}
constexpr double kFourthAtZero = 672.0;

using SampledSum = std::array<float, kSampledColumns>;
void add_weighted(SampledSum& sum, float weight, const float* values) noexcept {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += weight * values[i];
}

/// Adds neighbours in a ring, the first of them at `at`, each with its weight.
template <class Values>
DAMPLINE_WIDE void sum_ring(SampledSum& sum, std::span<const double> weights, const Values& values,
                            std::size_t at) noexcept {
  for (const double weight : weights) {
    add_weighted(sum, static_cast<float>(weight), values[at].data());
    if (++at == values.size()) at = 0;
  }
}

}  // namespace

Rows::Rows(double sample_rate_hz) noexcept : bank_{sample_rate_hz} {
  std::size_t start = 0;
  for (std::size_t s = 0; s < kScales; ++s) {
    const int half = bank_.half(s);
    const int reach = half + 1;
    const double norm = bank_.psi(s)[static_cast<std::size_t>(half)] / kFourthAtZero;
    const double scale = norm * sample_rate_hz / reach / 12.0;
    rate_start_[s] = start;
    for (int n = -reach; n <= reach; ++n) {
      lumped_rate_[start++] =
          scale * (fifth(n - 1, reach) + 10.0 * fifth(n, reach) + fifth(n + 1, reach));
    }
  }
}

void Rows::linear(std::size_t scale, std::int64_t tick, const RawRing& raw,
                  Row& row) const noexcept {
  const auto psi = bank_.lumped_psi(scale);
  const auto once = bank_.lumped_psi1(scale);
  const auto twice = bank_.lumped_double_integral(scale);
  const double* rate = lumped_rate_.data() + rate_start_[scale];
  const std::int64_t first = tick - bank_.half(scale) - 1;
  std::array<double, 8> sum{};
  for (std::size_t i = 0; i < psi.size(); ++i) {
    const RawRing::Entry& at = raw.at(first + static_cast<std::int64_t>(i));
    const auto& a = at.accel_mps2;
    sum[0] += rate[i] * a[0];
    sum[1] += once[i] * a[0];
    sum[2] += twice[i] * a[0];
    sum[3] += once[i] * a[1];
    sum[4] += twice[i] * a[1];
    sum[5] += once[i] * a[2];
    sum[6] += twice[i] * a[2];
    sum[7] += psi[i] * at.pushed_mps2;
  }
  // <psi, x'> = -<psi', x>; <psi, integral of x> = -<psi1, x>, twice: <Psi, x>
  row[kFrameRate] = -sum[0];
  row[kFrameOnce] = -sum[1];
  row[kFrameTwice] = sum[2];
  row[kWheelset1Once] = -sum[3];
  row[kWheelset1Twice] = sum[4];
  row[kWheelset2Once] = -sum[5];
  row[kWheelset2Twice] = sum[6];
  row[kTarget] = -sum[7];
}

Row Rows::row(std::size_t scale, std::int64_t tick, const RawRing& raw) const noexcept {
  SampledSum sum{};
  sum_ring(sum, bank_.psi(scale), values_, index(tick - bank_.half(scale)));
  Row row;
  for (int i = 0; i < kSampledColumns; ++i) row[i] = sum[static_cast<std::size_t>(i)];
  linear(scale, tick, raw, row);
  if (any_turn_) add_turn(scale, tick, row);
  return row;
}

/// Beside y = 2 z_b - z_1 - z_2, half of the turn's spring with each 2 z_b.
void Rows::add_turn(std::size_t scale, std::int64_t tick, Row& row) const noexcept {
  std::int64_t at = tick - bank_.half(scale);
  for (const double psi : bank_.psi(scale)) {
    const Turn& turn = turn_[index(at++)];
    row[kFrameTwice] += 0.5 * psi * turn.spring_m;
    row[kTarget] -= psi * turn.push_mps2;
  }
}

double Rows::still_share(std::size_t scale, std::int64_t tick) const noexcept {
  return bank_.marked_share(scale, still_, index(tick - bank_.half(scale)));
}

}  // namespace dampline::effect
