// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace dampline {

/// Counts of positive numbers of unknown size, in bins of equal ratio. `Scale` says which bin a
/// number belongs to and what a bin stands for; `Count` holds how many there were.
template <class Scale, class Count>
class CountsByRatio {
 public:
  void clear() noexcept {
    bins_.fill(0);
    count_ = 0;
  }
  [[nodiscard]] Count count() const noexcept { return count_; }

  /// Middle of the bin below whose end a share `q` of all lies; 0 without data.
  [[nodiscard]] double quantile(double q) const noexcept {
    if (count_ == 0) return 0.0;
    const double target = q * static_cast<double>(count_);
    double below = 0.0;
    std::size_t bin = 0;
    while (bin + 1 < Scale::kBins && below + static_cast<double>(bins_[bin]) < target)
      below += static_cast<double>(bins_[bin++]);
    return Scale::centre(bin);
  }

 protected:
  void count_in(std::size_t bin) noexcept {
    ++bins_[bin];
    ++count_;
  }

 private:
  std::array<std::uint32_t, Scale::kBins> bins_{};
  Count count_{0};
};

/// Eight bins to a factor of two, by shifts alone.
struct OctaveEighths {
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
};

/// Magnitudes that are whole numbers below 2^40; the median is good to 5 %. Zero has a bin of its
/// own.
class MagnitudeHistogram : public CountsByRatio<OctaveEighths, std::uint32_t> {
 public:
  void add(std::uint64_t magnitude) noexcept { count_in(OctaveEighths::bin_of(magnitude)); }
  [[nodiscard]] double median() const noexcept { return quantile(0.5); }
};

/// Sixteen bins to a factor of two, 2^-60 to 2^20; smaller and larger numbers count as the ends.
struct OctaveSixteenths {
  static constexpr std::size_t kBins = 1280;
  [[nodiscard]] static std::size_t bin_of(double x) noexcept {
    const double place = kPerOctave * (std::log2(x) - kLowest);
    return static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(kBins - 1)));
  }
  [[nodiscard]] static double centre(std::size_t bin) noexcept {
    return std::exp2(kLowest + (static_cast<double>(bin) + 0.5) / kPerOctave);
  }

 private:
  static constexpr double kPerOctave = 16.0;
  static constexpr double kLowest = -60.0;
};

/// Positive real numbers; a quantile is within 2.2 % of the true one. Others are not counted.
class LogHistogram : public CountsByRatio<OctaveSixteenths, std::uint64_t> {
 public:
  void add(double x) noexcept {
    if (x > 0.0) count_in(OctaveSixteenths::bin_of(x));
  }
};

}  // namespace dampline
