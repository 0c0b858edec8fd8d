// SPDX-License-Identifier: MIT
#include "dampline/guard/block_series.hpp"

#include <limits>

namespace dampline {
namespace {

constexpr double kLeastScatter = std::numeric_limits<double>::min();

}  // namespace

BlockSeries::Step BlockSeries::step() const noexcept {
  Step best;
  const double scatter_one = std::max(scatter(), kLeastScatter);
  double total = 0.0;
  for (std::size_t i = 0; i < size_; ++i) total += values_[i];
  double before = 0.0;
  for (std::size_t b = 1; b + kSide <= size_; ++b) {
    before += values_[b - 1];
    if (b < kSide) continue;
    const auto n1 = static_cast<double>(b);
    const auto n2 = static_cast<double>(size_ - b);
    const double size = (total - before) / n2 - before / n1;
    const double significance = std::abs(size) / (scatter_one * std::sqrt(1.0 / n1 + 1.0 / n2));
    if (significance > best.significance) best = {significance, size, b};
  }
  return best;
}

double BlockSeries::change_at(std::int64_t tick) const noexcept {
  std::size_t first = 0;
  while (first < size_ && ticks_[first] < tick) ++first;
  if (first < 2 || first + 2 > size_) return 0.0;
  const std::size_t before = std::min(first - 1, kSide);
  const std::size_t after = std::min(size_ - first - 1, kSide);
  double sum_before = 0.0;
  double sum_after = 0.0;
  for (std::size_t i = 0; i < before; ++i) sum_before += values_[first - 2 - i];
  for (std::size_t i = 0; i < after; ++i) sum_after += values_[first + 1 + i];
  return sum_after / static_cast<double>(after) - sum_before / static_cast<double>(before);
}

double BlockSeries::change_since(std::int64_t tick) const noexcept {
  std::size_t first = 0;
  while (first < size_ && ticks_[first] < tick) ++first;
  if (first + 4 > size_) return 0.0;
  return 0.5 * (values_[size_ - 1] + values_[size_ - 2] - values_[first] - values_[first + 1]);
}

BlockSeries::Trend BlockSeries::trend() const noexcept {
  if (size_ < 2 * kSide) return {};
  const double centre = 0.5 * static_cast<double>(size_ - 1);
  const double level = mean();
  double sxx = 0.0;
  double sxy = 0.0;
  for (std::size_t i = 0; i < size_; ++i) {
    const double x = static_cast<double>(i) - centre;
    sxx += x * x;
    sxy += x * (values_[i] - level);
  }
  const double slope = sxy / sxx;
  return {.significance = std::abs(slope) * std::sqrt(sxx) / std::max(scatter(), kLeastScatter),
          .per_block = slope,
          .total = slope * 2.0 * centre};
}

bool BlockSeries::is_straight(std::size_t block) const noexcept {
  struct Squares {
    double n{0.0}, x{0.0}, y{0.0}, xx{0.0}, xy{0.0}, yy{0.0};
    [[nodiscard]] double about_mean() const noexcept { return yy - y * y / n; }
    [[nodiscard]] double about_line() const noexcept {
      const double along = xy - x * y / n;
      return about_mean() - along * along / (xx - x * x / n);
    }
  };
  if (block < 2 || block + 2 > size_) return true;
  const double middle = median();
  std::array<Squares, 2> sides;
  Squares all;
  for (std::size_t i = 0; i < size_; ++i) {
    if (i == block || i + 1 == block) continue;
    const auto x = static_cast<double>(i);
    const double y = values_[i] - middle;
    for (Squares* const sum : {&all, &sides[i < block ? 0 : 1]}) {
      sum->n += 1.0;
      sum->x += x;
      sum->y += y;
      sum->xx += x * x;
      sum->xy += x * y;
      sum->yy += y * y;
    }
  }
  return all.about_line() < sides[0].about_mean() + sides[1].about_mean();
}

}  // namespace dampline
