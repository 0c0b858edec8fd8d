// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <cstdint>

#include "dampline/guard/block_series.hpp"
#include "dampline/guard/fault_log.hpp"

namespace dampline {

/// Whether samples are taken at uneven times. An instant that is off by e_n changes a sample by
/// a'(t_n) e_n: the difference of two wheelsets that see the same track grows with the momentary
/// slope of the acceleration, and not with the acceleration itself. What else the wheelsets do not
/// share grows with both alike, since both are large where the track is rough.
///   (difference)^2 = c_0 + c_1 a'^2 + c_2 w^2 a^2,   w^2 = <a'^2> / <a^2>,
///   variance of e = (c_1 - c_2) / 2, of each wheelset where both are alike.
/// What is proportional to a and a' throughout (a gain, a delay) is taken from the difference.
class JitterWatch {
 public:
  explicit JitterWatch(double sample_rate_hz) noexcept : rate_hz_{sample_rate_hz} {}

  /// `slope`: per sample; `difference`: wheelset 2 less wheelset 1, delayed.
  void update(double accel_mps2, double slope, double difference_mps2) noexcept;
  /// The samples since the last call belong to the block, or are dropped.
  void end_chunk(bool sound) noexcept;
  void close_block(bool sound, std::int64_t tick, FaultLog& log) noexcept;
  void restart() noexcept { chunk_ = block_ = Sums::Zero(); }

 private:
  /// Over samples; a: wheelset 2, d: its slope, e: what is left of the difference f.
  enum Sum : std::uint8_t {
    kSamples,
    kAA,
    kDD,
    kAD,
    kAF,
    kDF,
    kEE,
    kAAAA,
    kAADD,
    kDDDD,
    kAAEE,
    kDDEE
  };
  using Sums = Eigen::Array<double, 12, 1>;

  double rate_hz_;
  double gain_{0.0};   // of the difference on a and on d, in the block before
  double delay_{0.0};  // samples
  Sums chunk_ = Sums::Zero();
  Sums block_ = Sums::Zero();
  BlockSeries variance_;  // samples^2
  int sure_blocks_{0};    // in a row, that tell of jitter
};

}  // namespace dampline
