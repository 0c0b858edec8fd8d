// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "app/config/config.hpp"
#include "app/record/feed.hpp"

namespace dampline::app {

/// What the keys of a configuration do not tell one by one: the DBC file and its signals, a signal
/// for each channel, lines of the GPIO chip, a rate that a truck can be identified at, and no table
/// that nothing reads. Throws UsageError naming key, what was found and what was expected.
void check_configuration(const Config& config);

/// The configuration's first minute of a record: what each channel reads there, as lines to print.
/// Throws UsageError where the configuration does not fit the record, RunError where the record
/// cannot be read.
[[nodiscard]] std::string check_against_record(const Config& config, const SourceOptions& source);

}  // namespace dampline::app
