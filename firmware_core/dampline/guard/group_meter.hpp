// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#include "dampline/estimate/law_profile.hpp"
#include "dampline/estimate/statistics.hpp"

namespace dampline {

/// Level of friction and stiffness of the newest blocks alone, from how the sums over all blocks
/// have grown: the normal equations of a group are those of now less those of before. The law's
/// width and the weights of the scales are those of the first blocks and stay. For an infinite
/// memory only: the sums must not forget.
class GroupMeter {
 public:
  static constexpr std::uint32_t kFirstBlocks = 150;  ///< that fix the law, some 5 minutes
  static constexpr std::uint32_t kGroupBlocks = 30;   ///< a minute of motion

  struct Group {
    double friction_mps2{0.0};  ///< Fc / M
    double stiffness_ps2{0.0};  ///< k / M
  };
  /// Blocks in the sums at which update() has something to do.
  [[nodiscard]] std::uint32_t due() const noexcept { return due_; }
  /// True when it wrote a group. Some thousand operations; the first time some hundred thousand.
  bool update(const ScaleFactors& total, Group& out) noexcept;

 private:
  using Profile = LawProfile<false>;
  using Gram = Eigen::Matrix<double, Profile::kUnknowns + 1, Profile::kUnknowns + 1>;

  [[nodiscard]] Gram gram_of(const ScaleFactors& total) const noexcept;

  std::uint32_t due_{kFirstBlocks};
  bool has_law_{false};
  Profile law_{};
  Gram before_ = Gram::Zero();
};

}  // namespace dampline
