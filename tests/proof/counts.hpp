// SPDX-License-Identifier: MIT
// The instruction counts that are committed in tests/proof/counts, one file for each room and for
// each verb of the program. To write them anew after a change that is meant:
//   DAMPLINE_WRITE_COUNTS=1 build/release/tests/test_proof
//   --gtest_filter='*RoomCost*:*ProgramCost*'
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "tests/proof/profile.hpp"

namespace dampline::proof {

/// Why counts cannot be compared here, if they cannot: they are those of one compiler, and of
/// processors that take the functions for wider vectors.
[[nodiscard]] std::optional<std::string> why_not_counted();

/// Fails where the counts of `name` have grown by more than 3 %, and names the functions; fails as
/// well where they have shrunk by more than 10 %, so that a gain is committed and cannot be lost.
void check_counts(const std::string& name, const Profile& now, std::int64_t samples);

}  // namespace dampline::proof
