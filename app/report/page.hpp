// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "app/run/directory.hpp"
#include "app/run/provenance.hpp"
#include "app/run/result.hpp"

namespace dampline::app {

/// The whole run as one self-contained page that begins with the answer: drawings inline, style and
/// scripts too, and nothing is fetched. Some 75 KB beside the drawings and their numbers.
[[nodiscard]] std::string make_page(const RunResult& result, const Provenance& provenance,
                                    const std::string& run_toml);

/// Stages report.html.
void stage_report(const RunFiles& files, RunDirectory& directory);

}  // namespace dampline::app
