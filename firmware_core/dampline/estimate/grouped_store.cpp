// SPDX-License-Identifier: MIT
#include "dampline/estimate/grouped_store.hpp"

#include <cmath>

namespace dampline {
namespace {

// Half as many again as columns: fewer tell more of the columns than of the residual.
constexpr double kRowsThatTell = 1.5 * kRowColumns;
// Before, a residual is so much of the target's power: the middle of 0.003 to 0.07,
// bench/accuracy's four conditions, 60 s, seeds 1001 to 1003.
constexpr double kUsualResidual = 0.02;
constexpr double kFewestRows = 8.0;

/// Mean square of what a scale leaves of its target.
double residual_power(const RowFactor& factor, double rows) noexcept {
  if (rows < kRowsThatTell) {
    const double target = factor.column_norm(kTargetColumn);
    return kUsualResidual * target * target / rows;
  }
  const double norm = factor.residual_norm();
  return norm * norm / (rows - RowFactor::kUnknowns);
}

}  // namespace

GroupedStore::GroupedStore(const Config& config) noexcept
    : config_{config}, entries_{config.longest_entry(kMostEntries)} {}

bool GroupedStore::weigh() noexcept {
  for (std::size_t s = 0; s < kScales; ++s) {
    if (total_.rows[s] < kFewestRows) return false;
    const double power = residual_power(total_.factor[s], total_.rows[s]);
    if (!(power > 0.0)) return false;
    root_weight_[s] = 1.0 / std::sqrt(power);
  }
  return true;
}

void GroupedStore::absorb(std::int64_t block, std::size_t scale, const GalerkinRow& row) noexcept {
  total_.factor[scale].absorb(row);
  total_.rows[scale] += 1.0;
  Open& open = open_[Waiting::slot(block)];
  if (open.rows++ == 0) open.weighed = weigh();
  if (!open.weighed) return;
  const GalerkinRow weighed = root_weight_[scale] * row;
  open.factors.factor[group_of(scale)].absorb(weighed.cast<float>());
}

void GroupedStore::close(std::int64_t block) noexcept {
  Open& open = open_[Waiting::slot(block)];
  // At a gap a block without rows may close while the one before last waits in its place.
  if (open.rows == 0 || waiting_.holds(Waiting::slot(block))) return;
  ++total_.blocks;
  forget();
  if (!open.weighed) {
    open = Open{};
    return;
  }
  open.factors.blocks = 1;
  const bool at_rest = waiting_.empty();
  waiting_.push(Waiting::slot(block));
  if (at_rest) entries_.begin();
}

void GroupedStore::forget() noexcept {
  if (config_.memory != Memory::kForgetting) return;
  const double keep = config_.kept();
  for (RowFactor& f : total_.factor) f.scale(std::sqrt(keep));
  for (double& n : total_.rows) n *= keep;
}

void GroupedStore::advance() noexcept {
  Open& open = open_[waiting_.first()];
  if (!entries_.step(open.factors)) return;
  open = Open{};
  waiting_.pop();
  if (!waiting_.empty()) entries_.begin();
}

void GroupedStore::step() noexcept {
  for (int i = 0; i < kMergesPerStep && !waiting_.empty(); ++i) advance();
}

void GroupedStore::finish() noexcept {
  while (!waiting_.empty()) advance();
}

void GroupedStore::clear() noexcept {
  finish();
  total_.clear();
  entries_.clear();
}

}  // namespace dampline
