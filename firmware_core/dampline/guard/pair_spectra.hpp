// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>

#include "dampline/numeric/fourier.hpp"
#include "dampline/sample.hpp"

namespace dampline {

inline constexpr std::size_t kSpectrumBins = Fourier512::kSize / 2;

/// Bins from `first` to `last`; none where that is the one before it.
struct SpectrumBand {
  std::size_t first{0}, last{0};
  /// Those between two frequencies above 0.
  [[nodiscard]] static SpectrumBand between(double low_hz, double high_hz,
                                            double sample_rate_hz) noexcept;
  [[nodiscard]] bool holds(std::size_t k) const noexcept { return k >= first && k <= last; }
  [[nodiscard]] double bins() const noexcept { return static_cast<double>(last - first + 1); }
};

/// Sums over the segments of a block, by bin. Channel 1 is also seen delayed by a whole number of
/// samples, so that it stands beside channel 2. z = (a1 + a2) / 2.
struct SpectrumSums {
  using Real = std::array<double, kSpectrumBins>;
  using Cross = std::array<std::complex<double>, kSpectrumBins>;
  Real frame{}, wheelset1{}, wheelset2{}, delayed1{}, mean{};
  Cross wheelsets{};                ///< conj(A1) A2, channel 1 as it is
  Cross aligned{};                  ///< conj(A1) A2, channel 1 delayed
  std::array<Cross, 2> frame_to{};  ///< conj(A) F, per wheelset
  std::uint32_t segments{0};
  int delay{0};  ///< samples
  std::int64_t first_tick{0};
  std::int64_t last_tick{0};
  void clear() noexcept;
};

/// What one segment says by itself.
struct SegmentFigures {
  std::int64_t tick{0};        ///< its middle
  double excess_delay_s{0.0};  ///< of wheelset 2 behind wheelset 1, beyond the whole samples
};

/// Spectra of Hann-windowed segments of 512 samples, every 256 samples, of frame, both wheelsets
/// and the delayed wheelset 1: two complex transforms of two real signals each. The work of a
/// segment is spread over the 256 samples that follow it.
class PairSpectra {
 public:
  static constexpr std::int64_t kSegment = 512;
  static constexpr std::int64_t kHop = 256;
  static constexpr std::int64_t kMostDelay = 96;  ///< samples, either direction
  static constexpr std::uint32_t kSegmentsPerBlock = 12;
  using Weights = std::array<double, kSpectrumBins>;

  explicit PairSpectra(double sample_rate_hz) noexcept;

  /// One instant; `made_up` where samples were missing and a line was drawn across.
  void push(std::int64_t tick, const std::array<double, kChannels>& accel_mps2,
            bool made_up) noexcept;
  void restart() noexcept;
  /// A slice of the work that is due. True when a segment has just been added to sums().
  bool advance() noexcept;
  [[nodiscard]] const SegmentFigures& segment() const noexcept { return figures_; }
  [[nodiscard]] const SpectrumSums& sums() const noexcept { return sums_[open_]; }
  /// Ends the block. Its sums stay valid until the next block ends.
  [[nodiscard]] const SpectrumSums& take() noexcept;
  /// For the segments to come.
  void set_delay(int samples) noexcept { next_delay_ = samples; }
  /// Per bin: how much its phase counts for a segment's delay. Copied over in one go.
  void set_weights(const Weights& weights) noexcept { weights_ = weights; }

 private:
  static constexpr std::size_t kRing = 1024;
  enum class Stage : std::uint8_t { kIdle, kLoad, kTransform, kSum };

  void begin() noexcept;
  void load() noexcept;
  void transform() noexcept;
  bool sum() noexcept;
  void add_bin(std::size_t k) noexcept;
  [[nodiscard]] const std::array<double, kChannels>& at(std::int64_t n) const noexcept {
    return ring_[static_cast<std::size_t>(n) % kRing];
  }

  double rate_hz_;
  std::array<double, static_cast<std::size_t>(kSegment)> window_{};
  std::array<std::array<double, kChannels>, kRing> ring_{};
  std::int64_t count_{0};     // samples since the restart
  std::int64_t tick_{0};      // of the newest
  std::int64_t made_up_{0};   // newest made-up sample's index + 1
  std::int64_t next_end_{0};  // the sample count at which the next segment is complete
  Stage stage_{Stage::kIdle};
  std::size_t cursor_{0};
  std::int64_t start_{0};  // index of the segment's first sample
  std::int64_t start_tick_{0};
  int delay_{0};
  int next_delay_{0};
  Fourier512 wheelsets_;
  Fourier512 frame_;
  std::array<SpectrumSums, 2> sums_;
  std::size_t open_{0};
  Weights weights_{};
  double phase_sum_{0.0};
  double weight_sum_{0.0};
  SegmentFigures figures_{};
};

}  // namespace dampline
