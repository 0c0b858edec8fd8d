// SPDX-License-Identifier: MIT
#include "app/identify/convergence_history.hpp"

namespace dampline::app {

void ConvergenceHistory::add(std::int64_t tick, const Level& level) {
  next_ = tick + interval_;
  if (!level.valid) return;
  rows_.push_back({tick, level.coulomb_n, level.stiffness_npm});
  if (rows_.size() < kMost) return;
  for (std::size_t i = 0; i < rows_.size() / 2; ++i) rows_[i] = rows_[2 * i + 1];
  rows_.resize(rows_.size() / 2);
  interval_ *= 2;
  next_ = tick + interval_;
}

}  // namespace dampline::app
