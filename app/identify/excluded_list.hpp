// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "app/run/result.hpp"

namespace dampline::app {

/// Stretches of the record that were left out. Neighbours with one reason become one stretch.
/// Bounded: what comes after kMost stretches is only counted.
class ExcludedList {
 public:
  static constexpr std::size_t kMost = 2000;

  /// Stretches come in the order of time.
  void add(double start_s, double end_s, std::string_view reason) {
    const bool same = !list_.empty() && list_.back().reason == reason;
    if (same && more_ == 0 && start_s <= list_.back().end_s + kTouchingSeconds) {
      list_.back().end_s = end_s;
    } else if (list_.size() < kMost) {
      list_.push_back({start_s, end_s, std::string{reason}});
    } else {
      ++more_;
    }
  }
  [[nodiscard]] const std::vector<Excluded>& list() const noexcept { return list_; }
  [[nodiscard]] std::uint64_t more() const noexcept { return more_; }

 private:
  static constexpr double kTouchingSeconds = 0.01;
  std::vector<Excluded> list_;
  std::uint64_t more_{0};
};

}  // namespace dampline::app
