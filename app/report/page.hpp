// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "app/run/directory.hpp"
#include "app/run/provenance.hpp"
#include "app/run/result.hpp"

namespace dampline::app {

struct Page {
  std::string html;
  std::string warning;  ///< not empty: the plots are missing, and why
};

/// The whole run as one self-contained page: no script, no link, drawings inline.
[[nodiscard]] Page make_page(const RunResult& result, const Provenance& provenance,
                             const std::string& run_toml);

/// Stages report.html; warns where the plots are missing.
void stage_report(const RunFiles& files, RunDirectory& directory);

}  // namespace dampline::app
