// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/density/joint_histogram.hpp"

namespace dampline {

inline constexpr std::size_t kPictureCells = 96;

/// What a picture is worth.
enum class PictureState : std::uint8_t {
  kEmpty,     ///< no sample
  kConstant,  ///< all samples in one row, column or cell: a channel that does not vary
  kClipped,   ///< more than 1 % of the samples lie outside the range: the picture lacks them
  kGood
};

/// Probability density over one plane of the phase space.
struct PhasePicture {
  PictureState state{PictureState::kEmpty};
  double x_low{0.0}, x_high{0.0};  ///< range of the first axis, in its unit
  double y_low{0.0}, y_high{0.0};
  std::uint64_t samples{0};
  double outside_share{0.0};  ///< of the samples; 0 ... 1
  /// Per unit of x and of y; [i][j], i along x from its low end, j along y.
  std::array<std::array<float, kPictureCells>, kPictureCells> density{};
};

using PictureHistogram = JointHistogram<kPictureCells, kPictureCells>;

/// A pass over all cells: not for the sample path.
void make_picture(const PictureHistogram& histogram, PhasePicture& out) noexcept;

}  // namespace dampline
