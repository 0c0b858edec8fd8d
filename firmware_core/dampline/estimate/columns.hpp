// SPDX-License-Identifier: MIT
#pragma once
#include "dampline/damping/law_columns.hpp"
#include "dampline/estimate/information.hpp"

namespace dampline {

/// The columns of a Galerkin row, per unit of moving mass:
///   t = (k/M) X_k + (c/M) X_c + sum_i (F_i/M) X_i,   t = -<psi, z_b''>
/// First the law's columns (LawColumns), then these:
inline constexpr int kStiffnessColumn = LawColumns::kCount;
inline constexpr int kViscousColumn = kStiffnessColumn + 1;
inline constexpr int kTargetColumn = kViscousColumn + 1;
inline constexpr int kRowColumns = kTargetColumn + 1;

using RowFactor = Information<kRowColumns>;
using GalerkinRow = RowFactor::Row;

}  // namespace dampline
