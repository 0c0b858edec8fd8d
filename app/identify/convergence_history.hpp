// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>

#include "app/identify/touched.hpp"
#include "app/run/result.hpp"

namespace dampline::app {

/// How the level and the stiffness developed, in at most kMost rows however long the record is:
/// when they are full, every other row goes and the interval doubles. add() does not allocate.
class ConvergenceHistory {
 public:
  static constexpr std::size_t kMost = 240;

  /// `interval` ticks between rows at first.
  ConvergenceHistory(std::int64_t interval, std::int64_t first_tick)
      : interval_{interval}, next_{first_tick + interval} {
    reserve_touched(rows_, kMost);
  }
  /// Begins at another tick. Precondition: nothing was added yet.
  void start(std::int64_t first_tick) noexcept { next_ = first_tick + interval_; }
  [[nodiscard]] bool due(std::int64_t tick) const noexcept { return tick >= next_; }
  void add(std::int64_t tick, const Level& level);

  struct Row {
    std::int64_t tick{0};
    Estimate coulomb_n;
    Estimate stiffness_npm;
  };
  [[nodiscard]] const std::vector<Row>& rows() const noexcept { return rows_; }

 private:
  std::int64_t interval_;
  std::int64_t next_;
  std::vector<Row> rows_;
};

}  // namespace dampline::app
