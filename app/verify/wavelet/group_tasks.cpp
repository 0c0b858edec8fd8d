// SPDX-License-Identifier: MIT
#include "app/verify/wavelet/properties.hpp"
#include "app/verify/wavelet/selection.hpp"
#include "app/verify/wavelet/tasks.hpp"

namespace dampline::app {
namespace {
constexpr int kSeeds = 20;
}

const std::vector<GroupTask>& group_tasks() {
  static const std::vector<GroupTask> all{
      {{"17"}, single_selection},
      {{"18"}, chain_selection},
      {{"step"}, stiffness_drop},
      {{"precision"}, recursive_against_batch},
      {{"accelerometers"}, [] { return accelerometers_alone(kSeeds); }}};
  return all;
}

}  // namespace dampline::app
