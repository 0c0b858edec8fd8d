// SPDX-License-Identifier: MIT
#include "dampline/wavelet/row_builder.hpp"

#include <algorithm>
#include <array>

#include "dampline/numeric/wide.hpp"

namespace dampline {
namespace {

constexpr auto kLanes = static_cast<std::size_t>(LawColumns::kLanes);

/// sum += weight[i] (left[i] + right[-i]), lane by lane.
template <class Number>
DAMPLINE_WIDE void add_pairs(float* __restrict sum, const float* __restrict weight,
                             const Number* __restrict left, const Number* __restrict right,
                             std::size_t count) noexcept {
  std::array<float, kLanes> own{};
  for (std::size_t l = 0; l < kLanes; ++l) own[l] = sum[l];
  for (; count > 0; --count, ++weight, left += kLanes, right -= kLanes)
    for (std::size_t l = 0; l < kLanes; ++l)
      own[l] += *weight * static_cast<float>(left[l] + right[l]);
  for (std::size_t l = 0; l < kLanes; ++l) sum[l] = own[l];
}

/// Sums in four lanes: sample i goes to lane i % 4.
template <class Number>
struct LinearSums {
  using Lanes = std::array<Number, 4>;
  Lanes target{};
  Lanes stiffness{};
  Lanes viscous{};
};
template <class Number>
struct LinearWeights {
  const Number* psi;
  const Number* psi1;
  const Number* double_integral;
};

template <class Number>
DAMPLINE_WIDE void add_linear(LinearSums<Number>& sums, const LinearWeights<Number>& weights,
                              const Number* frame, const Number* relative,
                              std::size_t count) noexcept {
  auto target = wide(sums.target.data()).numbers;
  auto stiffness = wide(sums.stiffness.data()).numbers;
  auto viscous = wide(sums.viscous.data()).numbers;
  std::size_t i = 0;
  for (; i + 4 <= count; i += 4) {
    const auto r = wide(relative + i).numbers;
    target += wide(weights.psi + i).numbers * wide(frame + i).numbers;
    stiffness += wide(weights.double_integral + i).numbers * r;
    viscous += wide(weights.psi1 + i).numbers * r;
  }
  wide(sums.target.data()).numbers = target;
  wide(sums.stiffness.data()).numbers = stiffness;
  wide(sums.viscous.data()).numbers = viscous;
  for (std::size_t l = 0; i < count; ++i, ++l) {
    sums.target[l] += weights.psi[i] * frame[i];
    sums.stiffness[l] += weights.double_integral[i] * relative[i];
    sums.viscous[l] += weights.psi1[i] * relative[i];
  }
}

template <class Number>
double sum_of(const std::array<Number, 4>& lanes) noexcept {
  return (lanes[0] + lanes[2]) + (lanes[1] + lanes[3]);
}

}  // namespace

DAMPLINE_WIDE LawAverage::Lanes LawAverage::update(const LawColumns& law, double velocity_mps,
                                                   double accel_mps2, double step_s) noexcept {
  const double m0 = step_s * last_accel_mps2_;
  const double m1 = step_s * accel_mps2;
  const double v0 = last_velocity_mps_;
  const double v1 = velocity_mps;
  std::array<std::array<float, kLanes>, 4> p;  // NOLINT(cppcoreguidelines-pro-type-member-init)
  law.lanes_to(p[0].data(), v0);
  // Hermite weights at u = 1/4, 1/2, 3/4: (h00, h10, h01, h11) of u.
  law.lanes_to(p[1].data(), (54.0 * v0 + 9.0 * m0 + 10.0 * v1 - 3.0 * m1) / 64.0);
  law.lanes_to(p[2].data(), (4.0 * (v0 + v1) + m0 - m1) / 8.0);
  law.lanes_to(p[3].data(), (10.0 * v0 + 3.0 * m0 + 54.0 * v1 - 9.0 * m1) / 64.0);
  Lanes average;
  float* __restrict out = average.data();
  float* __restrict from_left = from_left_.data();
  for (std::size_t i = 0; i < kLanes; ++i) {
    out[i] =
        from_left[i] + 0.25F * p[0][i] + 0.1875F * p[1][i] + 0.125F * p[2][i] + 0.0625F * p[3][i];
    from_left[i] = 0.0625F * p[1][i] + 0.125F * p[2][i] + 0.1875F * p[3][i];
  }
  last_velocity_mps_ = velocity_mps;
  last_accel_mps2_ = accel_mps2;
  ++count_;
  return average;
}

template <class Keeps>
GalerkinRow BasicRowBuilder<Keeps>::row(std::size_t scale, std::int64_t n) const noexcept {
  GalerkinRow row;
  const LawColumns::Lanes law = law_columns(scale, n);
  row.head<LawColumns::kCount>() = LawColumns::values(law);
  row.tail<3>() = linear_columns(scale, n);
  row[kStiffnessColumn] += double{law[kTurnSpringLane]};
  row[kTargetColumn] -= double{law[kTurnPushLane]};
  return row;
}

template <class Keeps>
LawColumns::Lanes BasicRowBuilder<Keeps>::law_columns(std::size_t scale,
                                                      std::int64_t n) const noexcept {
  const int half = bank_.half(scale);
  const float* psi = bank_.half_psi(scale);
  std::size_t left = law(n - half);
  std::size_t right = law(n + half);
  LawColumns::Lanes sum = LawColumns::Lanes::Zero();
  for (auto pairs = static_cast<std::size_t>(half); pairs > 0;) {
    const std::size_t stretch = std::min({pairs, kLawRing - left, right + 1});
    add_pairs(sum.data(), psi, law_[left].data(), law_[right].data(), stretch);
    pairs -= stretch;
    psi += stretch;
    left = (left + stretch) % kLawRing;
    right = (right + kLawRing - stretch) % kLawRing;
  }
  for (int l = 0; l < LawColumns::kLanes; ++l)
    sum[l] = (sum[l] + *psi * static_cast<float>(law_[left][static_cast<std::size_t>(l)])) *
             Ring::step(l);
  return sum;
}

template <class Keeps>
Eigen::Vector3d BasicRowBuilder<Keeps>::linear_columns(std::size_t scale,
                                                       std::int64_t n) const noexcept {
  const std::size_t taps = bank_.lumped_psi(scale).size();
  const Number* psi = bank_.lumped_psi(scale).data();
  const Number* psi1 = bank_.lumped_psi1(scale).data();
  const Number* double_integral = bank_.lumped_double_integral(scale).data();
  LinearSums<Number> sums{};
  std::size_t at = raw(n - bank_.half(scale) - 1);
  for (std::size_t first = 0; first < taps; at = 0) {
    const std::size_t stretch = std::min(taps - first, kRawRing - at);
    add_linear<Number>(sums, {psi + first, psi1 + first, double_integral + first}, &frame_mps2_[at],
                       &relative_mps2_[at], stretch);
    first += stretch;
  }
  return {sum_of(sums.stiffness), -sum_of(sums.viscous), -sum_of(sums.target)};
}

template <class Keeps>
double BasicRowBuilder<Keeps>::still_share(std::size_t scale, std::int64_t n) const noexcept {
  if (newest_still_ < n - bank_.half(scale)) return 0.0;
  return bank_.marked_share(scale, still_, law(n - bank_.half(scale)));
}

template class BasicRowBuilder<FullRows>;
template class BasicRowBuilder<SmallRows>;

}  // namespace dampline
