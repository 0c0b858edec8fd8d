// SPDX-License-Identifier: MIT
#include "dampline/effect/gram_store.hpp"

namespace dampline::effect {
namespace {

double rows_of(const ScaleGrams& grams) noexcept {
  double sum = 0.0;
  for (const double n : grams.rows) sum += n;
  return sum;
}

}  // namespace

void GramStore::close(std::int64_t block) noexcept {
  ScaleGrams& open = open_[Waiting::slot(block)];
  if (rows_of(open) == 0.0 || waiting_.full()) return;
  open.blocks = 1;
  const bool at_rest = waiting_.empty();
  waiting_.push(Waiting::slot(block));
  if (at_rest) start();
}

void GramStore::copy_part(const GramStore& from, std::size_t part) noexcept {
  entries_.resize_as(from.entries_);
  const std::size_t e = part / kScales;
  entries_[e].copy(from.entries_[e], static_cast<int>(part % kScales));
  entries_[e].copy_counts(from.entries_[e]);
}

void GramStore::start() noexcept {
  ++revision_;
  entries_.begin();
}

void GramStore::step() noexcept {
  if (waiting_.empty()) return;
  ScaleGrams& from = open_[waiting_.first()];
  if (!entries_.step(from)) return;
  from.clear();
  waiting_.pop();
  if (!waiting_.empty()) start();
}

}  // namespace dampline::effect
