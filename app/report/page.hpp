// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "app/run/directory.hpp"
#include "app/run/provenance.hpp"
#include "app/run/result.hpp"

namespace dampline::app {

/// The whole run as one self-contained page: no script, no link, drawings inline.
[[nodiscard]] std::string make_page(const RunResult& result, const Provenance& provenance,
                                    const std::string& run_toml);

/// Stages report.html.
void stage_report(const RunFiles& files, RunDirectory& directory);

}  // namespace dampline::app
