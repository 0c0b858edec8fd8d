// SPDX-License-Identifier: MIT
#include "dampline/effect/evidence.hpp"

namespace dampline::effect {
namespace {

constexpr double kFewestRows = 100.0;

}  // namespace

bool Evidence::load(const GramStore& store) noexcept {
  count = store.count();
  rows.fill(0.0);
  ScaleWeights start{};
  bool any = false;
  for (std::size_t s = 0; s < kScales; ++s) {
    scale[s].clear();
    for (std::size_t e = 0; e < count; ++e) {
      scale[s].add(store.entry(e).gram[s]);
      rows[s] += store.entry(e).rows[s];
    }
    const double target = scale[s].at(kTarget, kTarget);
    if (rows[s] < kFewestRows || !(target > 0.0)) continue;
    start[s] = rows[s] / target;
    any = true;
  }
  if (any) weigh(store, start);
  return any;
}

void Evidence::weigh(const GramStore& store, const ScaleWeights& weights) noexcept {
  weight = weights;
  total.clear();
  for (std::size_t e = 0; e < count; ++e) {
    entry[e].clear();
    for (std::size_t s = 0; s < kScales; ++s) {
      if (weight[s] > 0.0) entry[e].add(store.entry(e).gram[s], weight[s]);
    }
    total.add(entry[e]);
  }
}

}  // namespace dampline::effect
