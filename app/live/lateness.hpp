// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace dampline::app {

/// Durations in a histogram of fixed size: 16 bins per factor of two, so that a quantile is known
/// to 6 %; the largest is exact. Negative durations count as 0.
class Lateness {
 public:
  void add(std::int64_t duration_ns) noexcept {
    const auto clipped = static_cast<std::uint64_t>(std::max<std::int64_t>(0, duration_ns));
    ++bins_[bin_of(clipped)];
    ++count_;
    max_ns_ = std::max(max_ns_, clipped);
  }
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] std::uint64_t max_ns() const noexcept { return max_ns_; }
  /// The upper edge of the bin below which `share` of all durations lie; 0 without any.
  [[nodiscard]] std::uint64_t quantile_ns(double share) const noexcept {
    const auto wanted = static_cast<std::uint64_t>(share * static_cast<double>(count_));
    std::uint64_t below = 0;
    for (std::size_t i = 0; i < kBins; ++i) {
      below += bins_[i];
      if (below > wanted) return std::min(upper_edge(i), max_ns_);
    }
    return max_ns_;
  }
  /// Calls `take(from_ns, to_ns, count)` for every bin that holds something, in ascending order;
  /// `to` is the first duration above it.
  template <class Take>
  void for_each(Take take) const {
    std::uint64_t from_ns = 0;
    for (std::size_t i = 0; i < kBins; ++i) {
      const std::uint64_t to_ns = upper_edge(i) + 1;
      if (bins_[i] > 0) take(from_ns, to_ns, bins_[i]);
      from_ns = to_ns;
    }
  }

 private:
  static constexpr unsigned kBitsPerOctave = 4;
  static constexpr std::size_t kPerOctave = std::size_t{1} << kBitsPerOctave;
  static constexpr std::size_t kBins = (64 - kBitsPerOctave + 1) * kPerOctave;

  /// Below kPerOctave the bins are single nanoseconds.
  static std::size_t bin_of(std::uint64_t ns) noexcept {
    if (ns < kPerOctave) return static_cast<std::size_t>(ns);
    const auto octave = static_cast<unsigned>(std::bit_width(ns)) - 1 - kBitsPerOctave;
    return (octave + 1) * kPerOctave + static_cast<std::size_t>((ns >> octave) - kPerOctave);
  }
  static std::uint64_t upper_edge(std::size_t bin) noexcept {
    if (bin < kPerOctave) return bin;
    const std::size_t octave = bin / kPerOctave - 1;
    const std::uint64_t mantissa = kPerOctave + bin % kPerOctave + 1;
    return (mantissa << octave) - 1;
  }

  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_{0};
  std::uint64_t max_ns_{0};
};

}  // namespace dampline::app
