// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "app/diagnosis/rig/explanation.hpp"

namespace dampline::app::rig {

/// How the force of like strokes, from one reversal to the next, changes over a record.
struct StrokeChange {
  int side{0};  ///< of the strokes: 1 or -1
  std::size_t strokes{0};
  Estimate range;       ///< of the force's peak, as a share of the model's
  double spread{0.0};   ///< standard deviation of the same
  double scatter{0.0};  ///< between neighbours, of it; about 1 where they are in no order
};

/// The side on which it changes more, where the same motion makes forces of a tenth more and less
/// and neighbours are alike; nothing where no side does.
[[nodiscard]] std::optional<StrokeChange> change_of_strokes(const std::vector<Series>& records,
                                                            const Model& model);

}  // namespace dampline::app::rig
