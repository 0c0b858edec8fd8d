// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/rig/rig_columns.hpp"

namespace dampline {

enum class RigParameter : std::uint8_t {
  kMovingMass,
  kStiffness,
  kViscous,
  kViscousPositive,
  kViscousNegative,
  kCoulomb,
  kCoulombPositive,
  kCoulombNegative,
  kOffset,
  kSlope,  ///< of one segment of the broken line
};

inline constexpr int kMaxRigUnknowns = 4 + 2 * static_cast<int>(kCurveSegments);

/// A model as columns of the equations: unknown j multiplies the row times column(j).
class RigModel {
 public:
  using Column = Eigen::Matrix<double, rig_column::kCount, 1>;

  RigModel() = default;  ///< no unknowns
  explicit RigModel(const RigTerms& terms) noexcept;
  /// The broken line on both branches instead of the dissipative terms. Its levels at v = 0 contain
  /// a constant force.
  [[nodiscard]] static RigModel curve(const RigTerms& terms) noexcept;

  [[nodiscard]] int size() const noexcept { return size_; }
  [[nodiscard]] RigParameter parameter(int j) const noexcept { return id_[as_size(j)]; }
  [[nodiscard]] const Column& column(int j) const noexcept { return columns_[as_size(j)]; }
  /// What was unknown j before any remove().
  [[nodiscard]] int origin(int j) const noexcept { return origin_[as_size(j)]; }
  void remove(int j) noexcept;

  /// The value of unknown j's column in `row`.
  [[nodiscard]] double value(int j, const RigInformation::Row& row) const noexcept {
    return column(j).dot(row);
  }

 private:
  static std::size_t as_size(int j) noexcept { return static_cast<std::size_t>(j); }
  Column& add(RigParameter id) noexcept;
  void add_linear(const RigTerms& terms) noexcept;
  void add_viscous(Branches branches) noexcept;
  void add_coulomb(Branches branches) noexcept;

  int size_{0};
  std::array<RigParameter, kMaxRigUnknowns> id_{};
  std::array<int, kMaxRigUnknowns> origin_{};
  std::array<Column, kMaxRigUnknowns> columns_{};
};

}  // namespace dampline
