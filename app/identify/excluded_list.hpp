// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "app/identify/touched.hpp"
#include "app/run/result.hpp"

namespace dampline::app {

/// Stretches of the record that were left out. Neighbours with one reason become one stretch.
/// Bounded: what comes after kMost stretches is only counted. add() does not allocate.
class ExcludedList {
 public:
  static constexpr std::size_t kMost = 2000;

  ExcludedList() { reserve_touched(list_, kMost); }
  /// Stretches come in the order of time. `reason` is a literal: it is not copied.
  void add(double start_s, double end_s, std::string_view reason) noexcept {
    const bool same = !list_.empty() && list_.back().reason == reason;
    if (same && more_ == 0 && start_s <= list_.back().end_s + kTouchingSeconds) {
      list_.back().end_s = end_s;
    } else if (list_.size() < kMost) {
      list_.push_back({start_s, end_s, reason});
    } else {
      ++more_;
    }
  }
  [[nodiscard]] std::vector<Excluded> list() const {
    std::vector<Excluded> out;
    for (const Stretch& s : list_) out.push_back({s.start_s, s.end_s, std::string{s.reason}});
    return out;
  }
  [[nodiscard]] std::uint64_t more() const noexcept { return more_; }

 private:
  static constexpr double kTouchingSeconds = 0.01;
  struct Stretch {
    double start_s{0.0};
    double end_s{0.0};
    std::string_view reason;
  };
  std::vector<Stretch> list_;
  std::uint64_t more_{0};
};

}  // namespace dampline::app
