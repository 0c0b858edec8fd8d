// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "app/diagnosis/rig/library.hpp"

namespace dampline::app::rig {

/// A friction with memory whose travel, or gap, is another one from some moment on.
struct MemoryChange {
  std::string effect;
  double before_m{0.0};  ///< travel; the shortest that is tried stands for none
  double after_m{0.0};
  double at_share{0.0};  ///< of the record
  Fit fit;               ///< in the smallest forms
};

/// The one that leaves least of a record, if it leaves clearly less than one travel at two levels
/// and than `known`, a law in its full form that does not change: otherwise other motion would pass
/// for another law. `base`: what stands beside the memory.
[[nodiscard]] std::optional<MemoryChange> change_of_memory(const Library& library,
                                                           const std::vector<Regressor>& base,
                                                           const Series& record, const Fit& known);

}  // namespace dampline::app::rig
