// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/faults.hpp"
#include "dampline/sample.hpp"
#include "dampline/sample/ticks.hpp"
#include "dampline/snapshot.hpp"

namespace dampline {

/// Samples whose own stamps say that they were taken at uneven times are put at even ones. What a
/// stamp is off the even raster, o ticks, may be the sample's own time or only the way of its
/// frame. It is the sample's own where the value is off as well, by the slope times o:
///   <D y, D (y' o)> / <(D (y' o))^2> = 1, and 0 where stamps tell nothing of the samples,
/// D the twelfth difference, which leaves little of the motion. Of a channel that has more than
/// half, the value on the raster is found by kRounds rounds of
///   x = y - o x' - o^2 x'' / 2.
///
/// While no channel is put anywhere samples are handed on at once, with their bits, and the stamps
/// are looked at now and then; later they wait for kAhead others.
class SamplePlacer {
 public:
  static constexpr std::int64_t kHalf = 12;  ///< values on either side of a slope
  static constexpr std::size_t kRounds = 3;
  /// Samples by which the output lags.
  static constexpr std::int64_t kAhead = kHalf * static_cast<std::int64_t>(kRounds);

  explicit SamplePlacer(double sample_rate_hz) noexcept;

  /// Ticks increase. Then pop() until it returns false.
  void push(const Sample& sample) noexcept;
  /// True when it wrote a sample as it was taken, and where it belongs.
  [[nodiscard]] bool pop(Sample& taken, Sample& placed) noexcept;
  /// No more samples: pop() hands out those that wait.
  void finish() noexcept { finished_ = true; }
  [[nodiscard]] PlacedFigures figures() const noexcept;

 private:
  static constexpr std::size_t kRing = 64;  // a power of two above kAhead + kHalf
  static constexpr std::size_t kDifferences = 12;
  static constexpr std::size_t kSlopeSpan = 7;

  struct Held {
    Sample sample{};
    std::array<double, kChannels> off{};  // ticks; 0: the sample stays where it is
    std::int64_t first{0};                // place from which ticks go on to this one
  };
  /// Whether what stamps are off is the samples' own, of one look.
  struct Look {
    std::array<double, kSlopeSpan> value{};  // the newest
    std::array<double, kSlopeSpan> off{};
    std::array<double, kDifferences> of_value{};
    std::array<double, kDifferences> of_moved{};  // of slope times off
    double samples{0.0};
    double square{0.0};                // of offs
    double vv{0.0}, vm{0.0}, mm{0.0};  // of the differences
    void take(double value_mps2, double off_ticks) noexcept;
    [[nodiscard]] Estimate share() const noexcept;  // 0: not known
  };
  struct Lane {
    explicit Lane(const TickLine& of_stamps) noexcept : line{of_stamps} {}
    TickLine line;
    bool started{false};
    int outside{0};  // stamps in a row that are too far off the line
    Look look;
    bool placed{false};
    std::uint64_t count{0};  // of values that were put elsewhere
    double square{0.0};      // of their offs
    std::array<std::array<double, kRing>, kRounds>
        values{};  // as taken; after each round but the last
  };

  [[nodiscard]] static std::size_t slot(std::int64_t place) noexcept {
    return static_cast<std::size_t>(place) % kRing;
  }
  void look_at(const Sample& sample) noexcept;
  [[nodiscard]] double off_of(std::size_t channel, const Sample& sample) noexcept;
  void judge(bool whole) noexcept;
  void place(std::size_t round, std::int64_t at, std::array<double, kChannels>& out) const noexcept;

  double rate_hz_;
  std::int64_t look_samples_;
  std::int64_t look_every_;
  std::int64_t judge_every_;
  std::array<double, kHalf + 1> slope_{};      // of x', by distance
  std::array<double, kHalf + 1> curvature_{};  // of x''
  std::array<Lane, kChannels> lanes_;
  std::array<Held, kRing> held_{};
  std::int64_t looked_{0};  // samples since the look began, or since it is time for none
  std::int64_t count_{0};   // places taken
  std::int64_t next_{0};    // place that comes out next
  bool active_{false};
  bool finished_{false};
};

}  // namespace dampline
