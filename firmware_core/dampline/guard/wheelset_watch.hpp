// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/guard/block_series.hpp"
#include "dampline/guard/fault_log.hpp"
#include "dampline/guard/jitter_watch.hpp"
#include "dampline/numeric/log_histogram.hpp"

namespace dampline {

/// Wheelset 2 beside the delayed wheelset 1 in one chunk of samples, for each shift of some whole
/// samples to either side; the middle entry is no shift.
struct ShiftSums {
  static constexpr std::int64_t kSamples = 4;  ///< of a chunk
  static constexpr int kReach = 4;
  static constexpr std::size_t kShifts = 2 * std::size_t{kReach} + 1;
  static constexpr std::size_t kNone = kReach;
  std::array<double, kShifts> error{};   ///< squared difference, sum
  std::array<double, kShifts> change{};  ///< of wheelset 1 shifted and not: squared difference, sum
};

/// Finds where all channels lost or repeated samples although the wheelsets differ at any time: for
/// as long as the delay lasts, wheelset 2 fits wheelset 1 shifted better than not shifted, and just
/// as clearly worse before and after. With z wheelset 1, z_s the same shifted, w what the wheelsets
/// do not share, |z_s - z|^2 = D and e_s = y - z_s: |e_0|^2 - |e_s|^2 is D + 2 w (z_s - z) where
/// y = z_s + w and -D + 2 w (z_s - z) where y = z + w; the last term deviates by 2 sigma sqrt(D).
class SlipFinder {
 public:
  struct Slip {
    std::int64_t tick{0};
    int samples{0};  ///< lost; negative: repeated
  };
  /// Of the chunk at `tick`. `delay_samples`: of wheelset 2, its sign apart; `sigma`: usual
  /// deviation of the difference. True when it wrote a slip, one delay and some samples late.
  [[nodiscard]] bool update(std::int64_t tick, const ShiftSums& chunk, std::int64_t delay_samples,
                            double sigma, Slip& out) noexcept;
  /// What comes next does not continue what came before.
  void restart() noexcept {
    count_ = 0;
    quiet_until_ = 0;
  }

 private:
  static constexpr std::size_t kMost = 23;  // chunks that lie wholly within a delay
  static constexpr std::size_t kRing = 64;  // more than twice that, and a few
  static constexpr int kMostShift = 3;
  struct Window {  // the newest `length` chunks
    std::int64_t tick{0};
    std::size_t shift{ShiftSums::kNone};           // that fits best
    double deviations{0.0};                        // by which it does
    double left{0.0};                              // squared difference then, over the usual one
    double share{1.0};                             // and over that without the shift
    std::array<double, ShiftSums::kShifts> fit{};  // 1: shifted; -1: not shifted
  };
  // Sums over the chunks up to the newest; that which leaves the least difference fits best.
  [[nodiscard]] Window window(std::int64_t tick, std::size_t length, double sigma) const noexcept;
  [[nodiscard]] static bool is_slip(const Window& found, const Window& before,
                                    const Window& after) noexcept;
  [[nodiscard]] const Window& back(std::size_t chunks) const noexcept {
    return windows_[(count_ - 1 - chunks) % kRing];
  }

  std::size_t count_{0};
  std::int64_t quiet_until_{0};  // tick; a slip is reported once
  double rough_{0.0};            // smoothed share of windows that no shift explains: impacts
  std::array<ShiftSums, kMost> chunks_{};
  std::array<Window, kRing> windows_{};
};

/// Wheelset 2 beside wheelset 1 delayed by a fraction of a sample, in the time domain.
///
/// Slip: where all channels lose or repeat a sample that nobody counted, the two stand one sample
/// apart for as long as the delay lasts, and then together again.
/// Saturation: y on x and on x^3 / s^2 - 3 x (s the rms of x); a sensor that saturates shows
/// a cubic part of one sign when it is y and of the other when it is x; an impact on one wheelset
/// shows in one direction only.
class WheelsetWatch {
 public:
  explicit WheelsetWatch(double sample_rate_hz) noexcept;

  void update(std::int64_t tick, double wheelset1_mps2, double wheelset2_mps2,
              FaultLog& log) noexcept;
  /// The delay of wheelset 2; takes effect with the next sample.
  void set_delay(double delay_s) noexcept;
  /// Block's end. `sound`: nothing spoils the block.
  void close_block(bool sound, std::int64_t tick, FaultLog& log) noexcept;
  /// An impact or wrong sample at this tick; may come some seconds late.
  void strike(std::int64_t tick) noexcept;
  void restart() noexcept;
  /// The delay of wheelset 2 is another than that set.
  [[nodiscard]] bool differs_from(double delay_s) const noexcept;
  /// The delay changed or is not known: what looked like a slip lately was none.
  void doubt() noexcept { slip_count_ = 0; }
  /// Root of the median of the squared difference of the wheelsets, of the newest blocks.
  [[nodiscard]] double difference_mps2() const noexcept;
  /// Where they last moved apart by whole samples at once and stayed so; -1: never.
  [[nodiscard]] std::int64_t jump_tick() const noexcept { return jump_tick_; }

 private:
  static constexpr std::size_t kRing = 512;
  static constexpr int kHalf = 12;  // taps on either side
  static constexpr std::int64_t kChunk = 2 * ShiftSums::kSamples;
  static constexpr int kReach = ShiftSums::kReach;  // slips of one sample less are recognised
  static constexpr std::size_t kShifts = ShiftSums::kShifts;
  struct Direction {  // y on {x, c}
    double xx{0.0}, xc{0.0}, cc{0.0}, xy{0.0}, cy{0.0};
    void add(double x, double c, double y) noexcept;
    void add(const Direction& other) noexcept;
    [[nodiscard]] double cubic() const noexcept;  // coefficient of c over that of x
  };
  using Slip = SlipFinder::Slip;
  void compare(std::int64_t tick) noexcept;
  void watch_jitter(std::int64_t n) noexcept;
  void end_chunk() noexcept;
  void follow_slip() noexcept;
  void hold(const Slip& slip) noexcept;
  void find_slip() noexcept;
  [[nodiscard]] bool struck(const Slip& slip, std::int64_t tick) const noexcept;
  void report_slips(std::int64_t tick, FaultLog& log) noexcept;
  void judge_saturation(std::int64_t tick, FaultLog& log) noexcept;
  [[nodiscard]] static double& ring(std::array<double, kRing>& of, std::int64_t n) noexcept {
    return of[static_cast<std::size_t>(n) % kRing];
  }

  double rate_hz_;
  bool has_delay_{false};
  std::int64_t whole_{0};  // samples of delay, and the taps of the fraction
  std::array<double, 2 * std::size_t{kHalf}> taps_{};
  std::array<double, kRing> one_{};
  std::array<double, kRing> two_{};
  std::array<double, kRing> delayed_{};  // wheelset 1 beside wheelset 2
  std::int64_t count_{0};
  std::array<double, 2> mean_{};
  std::array<double, 2> square_{};  // smoothed x^2
  std::int64_t chunk_samples_{0};
  std::int64_t chunk_tick_{0};
  ShiftSums sums_{};                          // of half a chunk
  std::array<double, kShifts> error_{};       // of this chunk, by shift
  std::array<double, kShifts> last_error_{};  // of the chunk before
  MagnitudeHistogram usual_;                  // mean squared error of chunks, in (mm/s^2)^2
  double usual_square_{0.0};                  // of the difference, mean; 0: not known yet
  SlipFinder finder_{};
  bool apart_{false};       // the wheelsets stand some whole samples apart just now
  bool too_long_{false};    // and longer than a slip does
  bool whole_slip_{false};  // by whole samples exactly
  double delay_samples_{0.0};
  Slip now_{};
  std::array<Slip, 8> slips_{};  // until impacts of that time are known
  std::size_t slip_count_{0};
  std::array<std::int64_t, 16> strikes_{};  // the newest
  std::size_t strike_count_{0};
  std::int64_t together_tick_{-1};
  std::int64_t leap_tick_{-1};  // a jump, if they stay apart
  std::int64_t jump_tick_{-1};
  MagnitudeHistogram block_usual_;  // as usual_, of the open block
  BlockSeries difference_;
  std::array<Direction, 2> chunk_{};
  std::array<Direction, 2> block_{};
  std::array<BlockSeries, 2> cubic_{};
  JitterWatch jitter_;
};

}  // namespace dampline
