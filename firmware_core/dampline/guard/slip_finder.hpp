// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

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

}  // namespace dampline
