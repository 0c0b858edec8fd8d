// SPDX-License-Identifier: MIT
#include "dampline/wavelet/row_builder.hpp"

#include <cmath>

namespace dampline {

GalerkinRow RowBuilder::row(std::size_t scale, std::int64_t n) const noexcept {
  const int half = bank_.half(scale);
  LawColumns::Values columns = LawColumns::Values::Zero();
  std::size_t at = law(n - bank_.half(scale));
  for (const double psi : bank_.psi(scale)) {
    columns += psi * law_[at];
    if (++at == kLawRing) at = 0;
  }
  const auto psi = bank_.lumped_psi(scale);
  const auto psi1 = bank_.lumped_psi1(scale);
  const auto double_integral = bank_.lumped_double_integral(scale);
  double target = 0.0;
  double stiffness = 0.0;
  double viscous = 0.0;
  for (std::size_t i = 0; i < psi.size(); ++i) {
    const std::size_t j = raw(n - half - 1 + static_cast<std::int64_t>(i));
    target -= psi[i] * frame_mps2_[j];
    stiffness += double_integral[i] * relative_mps2_[j];
    viscous -= psi1[i] * relative_mps2_[j];
  }
  GalerkinRow row;
  row << columns, stiffness, viscous, target;
  return row;
}

double RowBuilder::still_share(std::size_t scale, std::int64_t n) const noexcept {
  return bank_.marked_share(scale, still_, law(n - bank_.half(scale)));
}

}  // namespace dampline
