// SPDX-License-Identifier: MIT
#include "dampline/guard/group_meter.hpp"

#include "dampline/estimate/law_profile.hpp"

namespace dampline {
namespace {

using Model = LawModel<false>;
constexpr ScaleMask kAllScales{true, true, true, true, true};

}  // namespace

GroupMeter::Gram GroupMeter::gram_of(const ScaleFactors& total) const noexcept {
  return weighted_gram<Profile::kUnknowns>(law_.fit, total,
                                           MappedColumns<Profile::kUnknowns>{law_.map});
}

bool GroupMeter::update(const ScaleFactors& total, Group& out) noexcept {
  if (total.blocks < due_) return false;
  due_ = total.blocks + kGroupBlocks;
  if (!has_law_) {
    law_ = Profile::make(total, kAllScales);
    has_law_ = law_.fit.ok;
    if (has_law_) before_ = gram_of(total);
    return false;
  }
  const Gram now = gram_of(total);
  const Gram g = now - before_;
  before_ = now;
  const auto target = [&](int i) {
    return g(i, Profile::kUnknowns) -
           law_.fit.theta[Model::kWidthChange] * g(i, Model::kWidthChange);
  };
  constexpr int kF = Model::kCoulomb;
  constexpr int kK = Model::kStiffness;
  const double determinant = g(kF, kF) * g(kK, kK) - g(kF, kK) * g(kF, kK);
  if (!(determinant > 0.0)) return false;
  out.friction_mps2 = (g(kK, kK) * target(kF) - g(kF, kK) * target(kK)) / determinant;
  out.stiffness_ps2 = (g(kF, kF) * target(kK) - g(kF, kK) * target(kF)) / determinant;
  return true;
}

}  // namespace dampline
