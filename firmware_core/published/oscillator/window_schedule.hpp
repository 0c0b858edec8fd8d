// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <cstdint>
#include <optional>

namespace dampline {

/// Windows that were not used, and why.
struct ExcludedWindows {
  std::int64_t clipped{0};
  std::int64_t not_finite{0};
  std::int64_t gaps{0};
  std::int64_t quiet{0};         ///< the motion was too small
  std::int64_t undetermined{0};  ///< too few rows after the gate
  [[nodiscard]] std::int64_t total() const noexcept {
    return clipped + not_finite + gaps + quiet + undetermined;
  }
};

/// Cuts a stream into windows of `length` good samples, one every `hop`. A lost, clipped or
/// non-finite sample ends the window that is being filled, and the next one starts behind it.
class WindowSchedule {
 public:
  struct Config {
    int before;  ///< samples needed before a window
    int length;
    int after;  ///< samples needed behind it
    int hop;
    double clip_mps2;  ///< a magnitude from here on is not a measurement
  };
  explicit WindowSchedule(const Config& config) noexcept : config_{config}, start_{config.before} {}

  /// The number under which to store this sample; none where it is not to be stored.
  std::optional<std::int64_t> place(std::int64_t tick, double mass_mps2,
                                    double base_mps2) noexcept {
    if (count_ > run_start_ && tick != last_tick_ + 1) cut(excluded_.gaps);
    last_tick_ = tick;
    if (!std::isfinite(mass_mps2) || !std::isfinite(base_mps2)) {
      cut(excluded_.not_finite);
      return std::nullopt;
    }
    if (std::abs(mass_mps2) >= config_.clip_mps2 || std::abs(base_mps2) >= config_.clip_mps2) {
      cut(excluded_.clipped);
      return std::nullopt;
    }
    return count_++;
  }

  /// The first sample of a window that the last stored sample has completed.
  std::optional<std::int64_t> complete() noexcept {
    if (count_ != start_ + config_.length + config_.after) return std::nullopt;
    const std::int64_t first = start_;
    start_ += config_.hop;
    return first;
  }

  [[nodiscard]] const ExcludedWindows& excluded() const noexcept { return excluded_; }
  [[nodiscard]] ExcludedWindows& excluded() noexcept { return excluded_; }

 private:
  void cut(std::int64_t& counter) noexcept {
    if (count_ > run_start_) ++counter;
    run_start_ = count_;
    start_ = count_ + config_.before;
  }

  Config config_;
  ExcludedWindows excluded_;
  std::int64_t count_{0};
  std::int64_t run_start_{0};
  std::int64_t start_;
  std::int64_t last_tick_{0};
};

}  // namespace dampline
