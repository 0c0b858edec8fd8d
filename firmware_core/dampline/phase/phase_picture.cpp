// SPDX-License-Identifier: MIT
#include "dampline/phase/phase_picture.hpp"

namespace dampline {
namespace {

constexpr double kClippedShare = 0.01;

/// Whether the mass covers more than one column, and more than one row.
bool varies(const PhasePicture& picture) noexcept {
  std::array<bool, kPictureCells> columns{};
  std::array<bool, kPictureCells> rows{};
  std::size_t column_count = 0;
  std::size_t row_count = 0;
  for (std::size_t i = 0; i < kPictureCells; ++i) {
    for (std::size_t j = 0; j < kPictureCells; ++j) {
      if (!(picture.density[i][j] > 0.0F)) continue;
      column_count += columns[i] ? 0U : 1U;
      row_count += rows[j] ? 0U : 1U;
      columns[i] = true;
      rows[j] = true;
    }
  }
  return column_count > 1 && row_count > 1;
}

}  // namespace

void make_picture(const PictureHistogram& histogram, PhasePicture& out) noexcept {
  out.x_low = histogram.x_axis().low();
  out.x_high = histogram.x_axis().high();
  out.y_low = histogram.y_axis().low();
  out.y_high = histogram.y_axis().high();
  out.samples = histogram.samples();
  out.outside_share = histogram.share_outside();
  for (std::size_t i = 0; i < kPictureCells; ++i)
    for (std::size_t j = 0; j < kPictureCells; ++j)
      out.density[i][j] = static_cast<float>(histogram.density(i, j));
  if (out.samples == 0)
    out.state = PictureState::kEmpty;
  else if (out.outside_share > kClippedShare)
    out.state = PictureState::kClipped;
  else
    out.state = varies(out) ? PictureState::kGood : PictureState::kConstant;
}

}  // namespace dampline
