// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "app/run/result.hpp"
#include "app/run/run_toml.hpp"

namespace dampline::app {

/// The parts of the page that are text and tables, as HTML.
[[nodiscard]] std::string warning_section(const RunResult& result);
[[nodiscard]] std::string parameter_section(const RunResult& result);
[[nodiscard]] std::string quality_section(const RunResult& result);
[[nodiscard]] std::string excluded_section(const RunResult& result);
/// The methods beside the wavelet windows; those that the record contradicts are grey, with the
/// reasons. Empty where there are none.
[[nodiscard]] std::string method_section(const RunResult& result);
/// The planes of the phase space as density pictures, with the sections. Empty without them.
[[nodiscard]] std::string phase_section(const RunResult& result);
/// Of a live run; empty for a record.
[[nodiscard]] std::string live_section(const RunResult& result);
[[nodiscard]] std::string provenance_section(const Provenance& provenance,
                                             const std::string& run_toml);

}  // namespace dampline::app
