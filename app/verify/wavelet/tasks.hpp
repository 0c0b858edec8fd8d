// SPDX-License-Identifier: MIT
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "app/verify/wavelet/figures.hpp"

namespace dampline::app {

/// A case to recompute, known by the tables that it appears in.
struct CaseTask {
  std::vector<std::string> tables;
  std::function<CaseFigures()> run;
};
/// Tables 1, 3 to 6 and 8 to 16; "signs" and "noise" beside them.
[[nodiscard]] const std::vector<CaseTask>& case_tasks();

struct GroupTask {
  std::vector<std::string> tables;
  std::function<std::vector<CheckGroup>()> run;
};
/// Tables 17 and 18; "step", "precision" and "accelerometers" beside them.
[[nodiscard]] const std::vector<GroupTask>& group_tasks();

}  // namespace dampline::app
