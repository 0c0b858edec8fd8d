// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

#include "dampline/effect/gram_store.hpp"

namespace dampline::effect {

using ScaleWeights = std::array<double, kScales>;

/// The sums of a record with its scales weighted and added: what models are fitted to. About 1 MiB:
/// place it yourself.
struct Evidence {
  ScaleWeights weight{};
  ScaleWeights rows{};
  std::size_t count{0};
  std::array<Gram, kScales> scale{};  ///< of the whole record, not weighted
  std::array<Gram, kEffectEntries> entry{};
  Gram total;

  /// Sums by scale; scales with too few rows are left out. Weights become the inverse of the
  /// target's variance. False when no scale is left.
  bool load(const GramStore& store) noexcept;
  /// The sums of the entries anew with other weights.
  void weigh(const GramStore& store, const ScaleWeights& weights) noexcept;
};

}  // namespace dampline::effect
