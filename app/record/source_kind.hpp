// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <optional>

#include "app/config/config.hpp"
#include "app/record/feed.hpp"

namespace dampline::app {

enum class SourceKind : std::uint8_t {
  kFrames,     ///< of a truck's sensors, in a recording
  kBlackbox,   ///< the same, as a live run recorded them
  kInterface,  ///< a CAN interface, live
  kTruckRows,  ///< three accelerations
  kRigRows,    ///< deflection and force
};

/// What a source holds, by its content. Throws RunError naming what was found and what was
/// expected: no such file, a directory, empty, a format that is not read, columns of neither a
/// truck nor a rig.
[[nodiscard]] SourceKind detect_source(const Config& config, const SourceOptions& source);

/// Of frames alone: none where the source holds rows, of whatever columns. Throws as above.
[[nodiscard]] std::optional<SourceKind> detect_frames(const SourceOptions& source);

}  // namespace dampline::app
