// SPDX-License-Identifier: MIT
#include "dampline/wavelet/row_builder.hpp"

#include <algorithm>

namespace dampline {

GalerkinRow RowBuilder::row(std::size_t scale, std::int64_t n) const noexcept {
  LawColumns::Values columns = LawColumns::Values::Zero();
  std::size_t at = law(n - bank_.half(scale));
  for (auto psi = bank_.psi(scale); !psi.empty(); at = 0) {
    const std::size_t stretch = std::min(psi.size(), kLawRing - at);
    for (std::size_t i = 0; i < stretch; ++i) columns += psi[i] * law_[at + i];
    psi = psi.subspan(stretch);
  }
  GalerkinRow row;
  row.head<LawColumns::kCount>() = columns;
  row.tail<3>() = linear_columns(scale, n);
  return row;
}

Eigen::Vector3d RowBuilder::linear_columns(std::size_t scale, std::int64_t n) const noexcept {
  const auto psi = bank_.lumped_psi(scale);
  const auto psi1 = bank_.lumped_psi1(scale);
  const auto double_integral = bank_.lumped_double_integral(scale);
  double target = 0.0;
  double stiffness = 0.0;
  double viscous = 0.0;
  std::size_t at = raw(n - bank_.half(scale) - 1);
  for (std::size_t first = 0; first < psi.size(); at = 0) {
    const std::size_t stretch = std::min(psi.size() - first, kRawRing - at);
    for (std::size_t i = 0; i < stretch; ++i) {
      target -= psi[first + i] * frame_mps2_[at + i];
      stiffness += double_integral[first + i] * relative_mps2_[at + i];
      viscous -= psi1[first + i] * relative_mps2_[at + i];
    }
    first += stretch;
  }
  return {stiffness, viscous, target};
}

double RowBuilder::still_share(std::size_t scale, std::int64_t n) const noexcept {
  if (newest_still_ < n - bank_.half(scale)) return 0.0;
  return bank_.marked_share(scale, still_, law(n - bank_.half(scale)));
}

}  // namespace dampline
