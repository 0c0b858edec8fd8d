// SPDX-License-Identifier: MIT
#pragma once
#include "app/config/config.hpp"
#include "app/identify/sample_feed.hpp"
#include "app/identify/source_kind.hpp"

namespace dampline::app {

/// `config` with the rate that a truck's CSV file has by its own time, where none was set. Throws
/// RunError for a file that cannot be read.
[[nodiscard]] Config with_record_rate(Config config, const SourceOptions& source, SourceKind kind);

/// The identification's rate: the record's, or a whole part of it (thinner.hpp).
[[nodiscard]] double truck_rate_hz(const InputConfig& input);

}  // namespace dampline::app
