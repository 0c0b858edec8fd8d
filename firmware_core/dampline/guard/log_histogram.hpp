// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace dampline {

/// Counts of magnitudes in bins of an eighth of an octave; its median is good to 5 %. Zero has a
/// bin of its own. Magnitudes are whole numbers below 2^40.
class MagnitudeHistogram {
 public:
  void add(std::uint64_t magnitude) noexcept {
    ++bins_[bin_of(magnitude)];
    ++count_;
  }
  void clear() noexcept {
    bins_.fill(0);
    count_ = 0;
  }
  [[nodiscard]] std::uint32_t count() const noexcept { return count_; }
  /// Middle of the median's bin.
  [[nodiscard]] double median() const noexcept {
    std::uint32_t below = 0;
    for (std::size_t i = 0; i < kBins; ++i) {
      below += bins_[i];
      if (2 * below >= count_ && below > 0) return centre(i);
    }
    return 0.0;
  }

 private:
  static constexpr std::size_t kBins = 8 * 38 + 8;

  [[nodiscard]] static std::size_t bin_of(std::uint64_t magnitude) noexcept {
    if (magnitude < 8) return static_cast<std::size_t>(magnitude);
    const auto shift = static_cast<unsigned>(std::bit_width(magnitude)) - 4U;
    const auto bin = std::size_t{8} * shift + static_cast<std::size_t>(magnitude >> shift);
    return bin < kBins ? bin : kBins - 1;
  }
  [[nodiscard]] static double centre(std::size_t bin) noexcept {
    if (bin < 8) return static_cast<double>(bin);
    const std::size_t shift = bin / 8 - 1;
    const std::uint64_t low = static_cast<std::uint64_t>(bin - 8 * shift) << shift;
    return static_cast<double>(low) + 0.5 * static_cast<double>((std::uint64_t{1} << shift) - 1);
  }

  std::array<std::uint32_t, kBins> bins_{};
  std::uint32_t count_{0};
};

}  // namespace dampline
