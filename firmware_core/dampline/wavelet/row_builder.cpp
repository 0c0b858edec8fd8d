// SPDX-License-Identifier: MIT
#include "dampline/wavelet/row_builder.hpp"

#include <algorithm>

namespace dampline {

GalerkinRow RowBuilder::row(std::size_t scale, std::int64_t n) const noexcept {
  GalerkinRow row;
  row.head<LawColumns::kCount>() = LawColumns::values(law_columns(scale, n));
  row.tail<3>() = linear_columns(scale, n);
  return row;
}

LawColumns::Lanes RowBuilder::law_columns(std::size_t scale, std::int64_t n) const noexcept {
  const int half = bank_.half(scale);
  const double* psi = bank_.psi(scale).data();
  std::size_t left = law(n - half);
  std::size_t right = law(n + half);
  LawColumns::Lanes sum = LawColumns::Lanes::Zero();
  for (auto pairs = static_cast<std::size_t>(half); pairs > 0;) {
    const std::size_t stretch = std::min({pairs, kLawRing - left, right + 1});
    for (std::size_t i = 0; i < stretch; ++i)
      sum += static_cast<float>(psi[i]) * (law_[left + i] + law_[right - i]);
    pairs -= stretch;
    psi += stretch;
    left = (left + stretch) % kLawRing;
    right = (right + kLawRing - stretch) % kLawRing;
  }
  return sum + static_cast<float>(*psi) * law_[left];
}

Eigen::Vector3d RowBuilder::linear_columns(std::size_t scale, std::int64_t n) const noexcept {
  const auto psi = bank_.lumped_psi(scale);
  const auto psi1 = bank_.lumped_psi1(scale);
  const auto double_integral = bank_.lumped_double_integral(scale);
  using Pair = Eigen::Array2d;  // two samples at a time
  Pair target = Pair::Zero();
  Pair stiffness = Pair::Zero();
  Pair viscous = Pair::Zero();
  std::size_t at = raw(n - bank_.half(scale) - 1);
  for (std::size_t first = 0; first < psi.size(); at = 0) {
    const std::size_t stretch = std::min(psi.size() - first, kRawRing - at);
    std::size_t i = 0;
    for (; i + 1 < stretch; i += 2) {
      const Pair relative = Pair::Map(&relative_mps2_[at + i]);
      target -= Pair::Map(&psi[first + i]) * Pair::Map(&frame_mps2_[at + i]);
      stiffness += Pair::Map(&double_integral[first + i]) * relative;
      viscous -= Pair::Map(&psi1[first + i]) * relative;
    }
    if (i < stretch) {
      target[0] -= psi[first + i] * frame_mps2_[at + i];
      stiffness[0] += double_integral[first + i] * relative_mps2_[at + i];
      viscous[0] -= psi1[first + i] * relative_mps2_[at + i];
    }
    first += stretch;
  }
  return {stiffness.sum(), viscous.sum(), target.sum()};
}

double RowBuilder::still_share(std::size_t scale, std::int64_t n) const noexcept {
  if (newest_still_ < n - bank_.half(scale)) return 0.0;
  return bank_.marked_share(scale, still_, law(n - bank_.half(scale)));
}

}  // namespace dampline
