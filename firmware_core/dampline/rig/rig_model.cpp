// SPDX-License-Identifier: MIT
#include "dampline/rig/rig_model.hpp"

namespace dampline {
namespace {

constexpr int kSegments = static_cast<int>(kCurveSegments);

}  // namespace

RigModel::RigModel(const RigTerms& terms) noexcept {
  add_linear(terms);
  add_coulomb(terms.coulomb);
  add_viscous(terms.viscous);
  if (terms.offset) add(RigParameter::kOffset)[rig_column::kOne] = 1.0;
}

RigModel RigModel::curve(const RigTerms& terms) noexcept {
  RigModel model;
  model.add_linear(terms);
  model.add_coulomb(Branches::kSeparate);
  for (int i = 0; i < 2 * kSegments; ++i)
    model.add(RigParameter::kSlope)[rig_column::kRampPositive + i] = 1.0;
  return model;
}

RigModel::Column& RigModel::add(RigParameter id) noexcept {
  const std::size_t j = as_size(size_);
  id_[j] = id;
  origin_[j] = size_;
  columns_[j].setZero();
  ++size_;
  return columns_[j];
}

void RigModel::add_linear(const RigTerms& terms) noexcept {
  if (terms.inertia) add(RigParameter::kMovingMass)[rig_column::kInertia] = 1.0;
  if (terms.stiffness) add(RigParameter::kStiffness)[rig_column::kStiffness] = 1.0;
}

void RigModel::add_viscous(Branches branches) noexcept {
  if (branches == Branches::kCommon) add(RigParameter::kViscous)[rig_column::kViscous] = 1.0;
  if (branches != Branches::kSeparate) return;
  add(RigParameter::kViscousPositive).segment<kSegments>(rig_column::kRampPositive).setOnes();
  add(RigParameter::kViscousNegative).segment<kSegments>(rig_column::kRampNegative).setOnes();
}

/// The sign s is the expected one, so the share of time with v > 0 is (1 + s) / 2.
void RigModel::add_coulomb(Branches branches) noexcept {
  if (branches == Branches::kCommon) add(RigParameter::kCoulomb)[rig_column::kSign] = 1.0;
  if (branches != Branches::kSeparate) return;
  Column& positive = add(RigParameter::kCoulombPositive);
  positive[rig_column::kSign] = 0.5;
  positive[rig_column::kOne] = 0.5;
  Column& negative = add(RigParameter::kCoulombNegative);
  negative[rig_column::kSign] = 0.5;
  negative[rig_column::kOne] = -0.5;
}

void RigModel::remove(int j) noexcept {
  --size_;
  for (int i = j; i < size_; ++i) {
    id_[as_size(i)] = id_[as_size(i + 1)];
    origin_[as_size(i)] = origin_[as_size(i + 1)];
    columns_[as_size(i)] = columns_[as_size(i + 1)];
  }
}

}  // namespace dampline
