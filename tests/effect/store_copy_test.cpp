// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <memory>

#include "dampline/effect/gram_store.hpp"

namespace dampline::effect {
namespace {

/// A block whose every row is `value` in one column.
void add_block(GramStore& store, std::int64_t block, double value) {
  Row row = Row::Zero();
  row[kTarget] = value;
  for (std::size_t s = 0; s < kScales; ++s) store.absorb(block, s, row);
  store.close(block);
}

double target_of(const GramStore& store) {
  double sum = 0.0;
  for (std::size_t e = 0; e < store.count(); ++e) {
    for (const Gram& g : store.entry(e).gram) sum += g.at(kTarget, kTarget);
  }
  return sum;
}

TEST(StoreCopy, IsOfOneMomentWhileTheStoreGoesOn) {
  const auto store = std::make_unique<GramStore>();
  const auto copy = std::make_unique<StoreCopy>();
  int whole = 0;
  for (std::int64_t block = 0; block < 200; ++block) {
    add_block(*store, block, 1.0);
    copy->start();
    bool done = false;
    for (int step = 0; step < 600; ++step) {
      store->step();
      if (done || !copy->step(*store)) continue;
      done = true;
      ++whole;
      // Every block so far, in every scale.
      EXPECT_DOUBLE_EQ(target_of(copy->store()),
                       static_cast<double>(kScales) * static_cast<double>(block + 1));
      EXPECT_EQ(copy->store().count(), store->count());
    }
  }
  EXPECT_EQ(whole, 200);
}

TEST(StoreCopy, BeginsAnewWhenTheStoreChanges) {
  const auto store = std::make_unique<GramStore>();
  const auto copy = std::make_unique<StoreCopy>();
  for (std::int64_t block = 0; block < 10; ++block) {
    add_block(*store, block, 1.0);
    store->finish();
  }
  copy->start();
  for (int step = 0; step < 20; ++step) EXPECT_FALSE(copy->step(*store));
  add_block(*store, 10, 3.0);
  store->finish();
  int steps = 0;
  while (!copy->step(*store)) ++steps;
  EXPECT_GE(steps + 1, static_cast<int>(11 * kScales));
  EXPECT_DOUBLE_EQ(target_of(copy->store()), kScales * (10.0 + 9.0));
}

}  // namespace
}  // namespace dampline::effect
