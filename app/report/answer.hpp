// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "app/run/provenance.hpp"
#include "app/run/result.hpp"

namespace dampline::app {

/// The first input without its folders; "" where there is none.
[[nodiscard]] std::string record_name(const Provenance& provenance);

/// The head of the page: of which record, which vehicle and when; what is not known is not shown.
[[nodiscard]] std::string identity_section(const RunResult& result, const Provenance& provenance,
                                           const std::string& run_toml);

/// What was asked for, at a glance: friction level and stiffness with their bands, trust with its
/// reasons, load, speed and length. Numbers that are not to be trusted are not stated.
[[nodiscard]] std::string answer_section(const RunResult& result, const std::string& run_toml);

}  // namespace dampline::app
