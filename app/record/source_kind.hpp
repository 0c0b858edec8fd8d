// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

#include "app/config/config.hpp"
#include "app/record/feed.hpp"

namespace dampline::app {

enum class SourceKind : std::uint8_t {
  kCandump,    ///< frames of a truck's sensors
  kBlackbox,   ///< the same, as a live run recorded them
  kInterface,  ///< a CAN interface, live
  kTruckCsv,   ///< three accelerations
  kRigCsv,     ///< deflection and force
};

/// What a source holds, by its suffix and content. Throws RunError naming what was found and what
/// was expected: no such file, a directory, empty, neither candump text nor CSV, columns of neither
/// a truck nor a rig.
[[nodiscard]] SourceKind detect_source(const Config& config, const SourceOptions& source);

}  // namespace dampline::app
