// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace dampline {

/// A number a block, the newest kCapacity of them, and tests for a change. The scatter comes from
/// first differences, so that a slow change does not hide itself.
class BlockSeries {
 public:
  static constexpr std::size_t kCapacity = 60;
  static constexpr std::size_t kSide = 3;  ///< blocks on either side of a step

  struct Step {
    double significance{0.0};  ///< in standard deviations of the difference of the means
    double size{0.0};          ///< mean after minus mean before
    std::size_t block{0};      ///< first block after it
  };
  struct Trend {
    double significance{0.0};
    double per_block{0.0};
    double total{0.0};  ///< over the series
  };

  void add(double value, std::int64_t tick) noexcept {
    if (size_ == kCapacity) drop(1);
    ticks_[size_] = tick;
    values_[size_++] = value;
  }
  /// Forgets the oldest.
  void drop(std::size_t count) noexcept {
    const auto gone = static_cast<std::ptrdiff_t>(std::min(count, size_));
    std::move(values_.begin() + gone, values_.begin() + static_cast<std::ptrdiff_t>(size_),
              values_.begin());
    std::move(ticks_.begin() + gone, ticks_.begin() + static_cast<std::ptrdiff_t>(size_),
              ticks_.begin());
    size_ -= static_cast<std::size_t>(gone);
  }
  /// Forgets what is older than this tick.
  void drop_before(std::int64_t tick) noexcept {
    std::size_t count = 0;
    while (count < size_ && ticks_[count] < tick) ++count;
    drop(count);
  }
  void clear() noexcept { size_ = 0; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] double operator[](std::size_t i) const noexcept { return values_[i]; }
  [[nodiscard]] std::int64_t tick(std::size_t i) const noexcept { return ticks_[i]; }
  [[nodiscard]] double back() const noexcept { return values_[size_ - 1]; }

  /// sqrt(median(d^2) / 0.4549 / 2) of the first differences d; 0.4549 is the median of chi^2_1.
  [[nodiscard]] double scatter() const noexcept {
    if (size_ < 2) return 0.0;
    std::array<double, kCapacity> squares{};
    for (std::size_t i = 1; i < size_; ++i) {
      const double d = values_[i] - values_[i - 1];
      squares[i - 1] = d * d;
    }
    return std::sqrt(middle(squares, size_ - 1) / 0.4549 / 2.0);
  }
  [[nodiscard]] double median() const noexcept {
    std::array<double, kCapacity> copy = values_;
    return size_ == 0 ? 0.0 : middle(copy, size_);
  }
  /// The newest `count`, or all where there are fewer.
  [[nodiscard]] BlockSeries newest(std::size_t count) const noexcept {
    BlockSeries out = *this;
    out.drop(size_ - std::min(size_, count));
    return out;
  }
  [[nodiscard]] double mean() const noexcept {
    double sum = 0.0;
    for (std::size_t i = 0; i < size_; ++i) sum += values_[i];
    return size_ == 0 ? 0.0 : sum / static_cast<double>(size_);
  }
  [[nodiscard]] double range() const noexcept {
    if (size_ == 0) return 0.0;
    const auto end = values_.begin() + static_cast<std::ptrdiff_t>(size_);
    const auto [low, high] = std::minmax_element(values_.begin(), end);
    return *high - *low;
  }
  /// Mean of up to kSide blocks after this tick minus that of up to kSide before it; the nearest
  /// block on either side may hold the change and is left out.
  [[nodiscard]] double change_at(std::int64_t tick) const noexcept;
  /// Mean of the newest two blocks minus that of the first two from this tick on.
  [[nodiscard]] double change_since(std::int64_t tick) const noexcept;
  /// The most significant step with kSide blocks on either side.
  [[nodiscard]] Step step() const noexcept;
  [[nodiscard]] Trend trend() const noexcept;
  /// Whether a line leaves less, in squares, than the means on either side of a step at `block`.
  /// The nearest block on either side may hold the change, and counts for neither.
  [[nodiscard]] bool is_straight(std::size_t block) const noexcept;

 private:
  [[nodiscard]] static double middle(std::array<double, kCapacity>& values,
                                     std::size_t count) noexcept {
    auto* const nth = values.data() + count / 2;
    std::nth_element(values.data(), nth, values.data() + count);
    return *nth;
  }
  std::array<double, kCapacity> values_{};
  std::array<std::int64_t, kCapacity> ticks_{};
  std::size_t size_{0};
};

}  // namespace dampline
