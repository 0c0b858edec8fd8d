// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/identify/sample_feed.hpp"

namespace dampline::app {

struct RecognisedColumns {
  Config config;                   ///< with [input.columns] and [input.scale] as recognised
  std::vector<std::string> notes;  ///< what was understood, a sentence each
};

/// Columns of a rig's CSV file whose names are not canonical and that the configuration does not
/// name: by the words and the unit in the header, where exactly one fits. Nothing is guessed: a
/// unit that is missing or that contradicts a canonical name throws RunError with the lines that
/// the configuration needs. What is no CSV file, and a truck's record, come back as they are.
[[nodiscard]] RecognisedColumns recognise_columns(const Config& given, const SourceOptions& source);

}  // namespace dampline::app
