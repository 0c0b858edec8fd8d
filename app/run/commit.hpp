// SPDX-License-Identifier: MIT
#pragma once

namespace dampline::app {

/// As `git describe --always --dirty` names what was built; empty: not known. Its definition is
/// written by commit.cmake.
extern const char* const kCommit;

}  // namespace dampline::app
