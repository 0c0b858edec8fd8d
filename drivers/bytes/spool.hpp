// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "drivers/outcome.hpp"

namespace dampline::drivers {

/// The path of a file that can be read several times, and anywhere in it, with what `path` gives:
/// of a pipe, standard input or a compressed file a copy without a name in the folder for temporary
/// files, which goes with the process; of a file its own path. Waits for a pipe's end.
/// A pipe is copied once: its copy is given again.
[[nodiscard]] Outcome<std::string> spooled(const std::string& path);
/// The copy of a pipe that was copied; else `path` itself.
[[nodiscard]] std::string spooled_before(const std::string& path);

}  // namespace dampline::drivers
