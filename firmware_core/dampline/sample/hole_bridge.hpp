// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/faults.hpp"
#include "dampline/sample.hpp"
#include "dampline/snapshot.hpp"

namespace dampline {

/// Values that are missing here and there (a lost frame, an empty cell) are put in where at most
/// kMostMissing in a row are: a channel's own prediction is learned from what it did just before,
/// and the missing values are those that leave the least of the prediction's errors around them
/// (Janssen, Veldhuis and Vries 1986). One value of a wheelset is met to an eighth of its rms, of
/// two or three in a row to a third. What is missing for longer stays missing: a sample that came
/// without a channel is not handed on, so its tick is jumped over; a value that is no number is
/// handed on as it is.
///
/// Samples wait for kAhead others. A hole costs some 10^4 operations, a sample without one next to
/// nothing; it comes out with the bits that it came with.
class HoleBridge {
 public:
  static constexpr std::int64_t kMostMissing = 3;  ///< values of a channel in a row
  static constexpr std::int64_t kAhead = 20;       ///< samples by which the output lags
  static constexpr std::int64_t kOrder = 16;       ///< samples from which the next is predicted
  static constexpr std::int64_t kPast = 512;       ///< samples from which that is learned
  /// Share of samples from which on errors of what was put in look like bursts and strikes.
  static constexpr double kMany = 0.01;

  HoleBridge() noexcept;

  /// Ticks increase. A channel whose value is missing is no number (NaN). Then pop() until it
  /// returns false, at most kMostMissing + 1 times.
  void push(const Sample& sample) noexcept;
  /// True when it wrote a sample.
  [[nodiscard]] bool pop(Sample& out) noexcept;
  /// No more samples: pop() hands out those that wait.
  void finish() noexcept { finished_ = true; }
  [[nodiscard]] BridgeFigures figures() const noexcept;

 private:
  static constexpr std::size_t kLanes = kChannels + kExtras;
  static constexpr std::int64_t kKept = kPast + kAhead + kMostMissing + 2;
  static constexpr std::size_t kWaiting = 32;  // a power of two above what can wait
  static constexpr int kMostUnknown = 8;       // missing values that are found together
  static constexpr std::int64_t kLeastBefore = 8;
  static constexpr std::int64_t kLeastAhead = 6;
  static constexpr std::int64_t kLearnAgain = 150;

  struct Held {
    Sample sample{};
    std::int64_t first{0};     // place of the first sample from which ticks go on to this one
    std::uint32_t missing{0};  // bit l: lane l has no value
  };
  /// Missing values of a lane, and the last place that helps to find them.
  struct Unknown {
    std::array<std::int64_t, kMostUnknown> place{};
    int size{0};
    std::int64_t last{0};
  };
  struct Lane {
    /// By place, modulo kKept, each twice so that the newest kKept lie in one piece.
    std::array<double, 2 * kKept> values{};
    std::array<double, kOrder + 1> model{1.0, -2.0, 1.0};  // until one is learned: a smooth curve
    double mean{0.0};
    double unforeseen{0.0};    // power of the prediction's errors, (m/s^2)^2
    std::int64_t learned{-1};  // place
    bool refused{false};       // the newest that came out had no value, and got none
    std::uint64_t filled{0};
    double sum_squares{0.0};  // of the stated errors of what was filled
  };

  [[nodiscard]] Held& held(std::int64_t place) noexcept {
    return waiting_[static_cast<std::size_t>(place) % kWaiting];
  }
  void take(const Sample& sample) noexcept;
  static void put(Lane& lane, std::int64_t place, double value) noexcept;
  /// The newest values up to a place, that one the last.
  [[nodiscard]] static const double* up_to(const Lane& lane, std::int64_t place) noexcept {
    return lane.values.data() + kKept + place % kKept;
  }
  /// False when it came out with a hole that makes it useless.
  [[nodiscard]] bool complete(std::int64_t place) noexcept;
  [[nodiscard]] bool fill(std::size_t index, std::int64_t place) noexcept;
  [[nodiscard]] bool is_missing(std::size_t lane, std::int64_t place) noexcept {
    return (held(place).missing >> lane & 1U) != 0;
  }
  [[nodiscard]] bool is_short(std::size_t lane, std::int64_t place, std::int64_t last) noexcept;
  [[nodiscard]] Unknown unknown_of(std::size_t lane, std::int64_t place,
                                   std::int64_t last) noexcept;
  [[nodiscard]] static bool solve(const Lane& lane, std::int64_t first, const Unknown& unknown,
                                  Estimate& out) noexcept;
  [[nodiscard]] std::int64_t last_of(std::int64_t place) noexcept;
  void learn(Lane& lane, std::int64_t place, std::int64_t first) noexcept;

  std::array<Held, kWaiting> waiting_{};
  std::array<Lane, kLanes> lanes_{};
  std::array<double, kPast> taper_{};
  std::int64_t count_{0};   // places taken
  std::int64_t next_{0};    // place that comes out next
  std::int64_t intact_{0};  // first place after the newest that stayed incomplete
  std::size_t slot_{0};     // of the next place in the lanes
  bool finished_{false};
  std::uint64_t bridged_{0};  // samples
};

}  // namespace dampline
