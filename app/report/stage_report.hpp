// SPDX-License-Identifier: MIT
#pragma once
#include "app/run/directory.hpp"
#include "app/run/files.hpp"

namespace dampline::app {

/// Stages report.html; warns where the plots are missing.
void stage_report(const RunFiles& files, RunDirectory& directory);

}  // namespace dampline::app
