// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "dampline/result.hpp"
#include "dampline/sample.hpp"

namespace dampline {

/// In order of rank: a sample with several faults has the last.
enum class Verdict : std::uint8_t { kGood, kSpoilt, kStuck, kSaturated, kNotFinite };

/// No accelerometer reaches what is no number.
inline constexpr double kNoNumberMps2 = 1e6;
[[nodiscard]] inline bool is_number(double accel_mps2) noexcept {
  return std::abs(accel_mps2) < kNoNumberMps2;  // false for NaN
}

/// A sample and whether its values are what the car did.
struct Screened {
  Sample sample{};
  Verdict verdict{Verdict::kGood};
  std::uint8_t channels{0};  ///< bit c set: channel c is the reason
};

/// A channel is stuck when it holds one value for 0.2 s and at least 80 samples, while others span
/// more than eight of their steps: the screen leaves it out, the guard names it. Clean records of
/// 12 bits hold a code for 10 samples at most, a car's own of 8 bits for 53.
inline constexpr double kStuckS = 0.2;
inline constexpr double kStuckSamples = 80.0;
inline constexpr int kStepsMoved = 8;
[[nodiscard]] constexpr double stuck_samples(double sample_rate_hz) noexcept {
  return std::max(kStuckS * sample_rate_hz, kStuckSamples);
}

struct ScreenConfig {
  double sample_rate_hz{300.0};
  /// Resolution of each channel; it moves when it spans kStepsMoved of them. 0: unknown.
  std::array<double, kChannels> step_mps2{};
  double moved_mps2{0.5};  ///< moves when it spans more than this, where the step is unknown
  /// For inputs without a known full scale: flat tops at the extreme of the record are saturation.
  bool find_flat_tops{false};
};

/// Screens samples before anything uses them. They come out stuck_samples() later, because it takes
/// that long to know that a channel is stuck, and the verdict must reach back to the first stuck
/// sample. A sensor that is quiet because the car stands is not stuck: then no other channel moves.
template <std::size_t kMost>
class BasicSampleScreen {
 public:
  static constexpr std::size_t kCapacity = kMost;  ///< samples; the most that it waits for
  static constexpr std::int64_t kFlatTop = 4;      ///< equal values in a row at the extreme

  /// kInvalidConfig unless the rate and moved_mps2 are positive, the steps not negative.
  [[nodiscard]] static Result<ScreenConfig> check(const ScreenConfig& config) noexcept;
  /// Precondition: check(config).ok().
  explicit BasicSampleScreen(const ScreenConfig& config) noexcept;

  /// True when it wrote the sample that is now old enough.
  bool push(const Sample& sample, Screened& out) noexcept;
  /// End of the record: the samples that are still held, one per call.
  bool drain(Screened& out) noexcept;
  /// Samples by which the output lags.
  [[nodiscard]] std::size_t delay() const noexcept { return window_ - 1; }

 private:
  /// One channel's run of equal values.
  struct Run {
    double value{0.0};
    std::int64_t first_tick{0};
    std::int64_t samples{0};
    bool stuck{false};
    // Where flat tops are looked for, what the channel has reached so far.
    double step_mps2{0.0};  // least change so far
    double count{0.0};      // of finite values, their mean and sum of squares about it
    double mean{0.0};
    double sum_squares{0.0};
    double lowest{0.0};
    double highest{0.0};
    bool flat_bottom{false};  // the lowest value is a level at which the channel clips
    bool flat_top{false};     // so is the highest
  };
  struct Held {
    Sample sample{};
    std::array<Verdict, kChannels> verdict{};
  };

  void mark(std::size_t channel, std::int64_t samples, Verdict verdict) noexcept;
  static void follow(Run& run, double value, std::int64_t tick, bool paused) noexcept;
  /// Before the value joins the run.
  static void follow_extremes(Run& run, double value) noexcept;
  /// Of a channel that holds one value, or was found stuck.
  void judge_stuck(std::size_t channel) noexcept;
  void judge_flat_top(std::size_t channel) noexcept;
  [[nodiscard]] bool rises_steeply(std::size_t channel) const noexcept;
  /// One value for the whole window, up to this tick.
  [[nodiscard]] bool holds(std::size_t channel, std::int64_t tick) const noexcept;
  [[nodiscard]] bool moved(std::size_t channel) const noexcept;
  [[nodiscard]] Held& held(std::size_t age) noexcept;
  [[nodiscard]] const Held& held(std::size_t age) const noexcept;
  void take_oldest(Screened& out) noexcept;

  std::size_t window_;
  ScreenConfig config_;
  std::array<Run, kChannels> runs_{};
  std::array<Held, kCapacity> ring_{};
  std::size_t newest_{0};  // slot of the newest
  std::size_t count_{0};
};

using SampleScreen = BasicSampleScreen<256>;

}  // namespace dampline
