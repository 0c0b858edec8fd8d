// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>

#include "dampline/faults.hpp"
#include "dampline/guard/block_survey.hpp"
#include "dampline/guard/fault_log.hpp"
#include "dampline/guard/pair_spectra.hpp"

namespace dampline {

/// Whether the sensors sit where they tell the motion of one truck.
///
/// Over the middle of a frame nothing is seen of its pitch, which the difference of the wheelsets
/// makes; and below the suspension's resonance the frame does what the wheelsets do. With m and d
/// half the sum and half the difference of the wheelsets' accelerations and f the frame's,
///   f = H_m m + H_d d + what is foreign to both
/// in every bin, by least squares over the blocks. A mount that rings shows as a narrow peak of a
/// channel over the others.
class PlaceWatch {
 public:
  explicit PlaceWatch(double sample_rate_hz) noexcept;

  /// A block that was surveyed; `sums` must stay as it is until done.
  void start(const SpectrumSums& sums, const BlockFigures& figures) noexcept;
  /// A slice of the work; true when the block is done. A mount that rings goes to the log.
  [[nodiscard]] bool advance(FaultLog& log) noexcept;
  /// Of the blocks so far; what is long ago counts less.
  [[nodiscard]] Misplacement misplacement() const noexcept;

 private:
  using Complex = std::complex<double>;
  static constexpr std::size_t kMostBins = 16;
  static constexpr std::size_t kBandBins = 5;
  static constexpr std::size_t kMostBands = 48;
  /// Powers and products conj(first) second of a bin.
  struct Bin {
    double frame{0.0}, mean{0.0};
    double wheelset1{0.0}, wheelset2{0.0};
    Complex mean_frame{}, difference_frame{}, mean_difference{};
  };
  using Bands = std::array<double, kMostBands>;
  struct Ringing {
    std::size_t band{0};
    int blocks{0};  // in a row
  };

  void add(std::size_t k) noexcept;
  void add(std::size_t k, Bin& bin) const noexcept;
  void judge_mounts(FaultLog& log) noexcept;

  double bin_hz_;
  SpectrumBand below_;  // the resonance
  SpectrumBand pitch_;
  SpectrumBand mounts_;
  std::array<Bin, kMostBins> below_bins_{};
  std::array<Bin, kMostBins> pitch_bins_{};
  double noise_{0.0};  // of the frame's sums below the resonance
  std::uint32_t blocks_{0};
  Bands frame_{}, wheelsets_{}, wheelset1_{}, wheelset2_{};  // of this block
  std::array<Ringing, kChannels> ringing_{};
  const SpectrumSums* block_{nullptr};
  double density_{0.0};
  std::size_t cursor_{0};
};

}  // namespace dampline
