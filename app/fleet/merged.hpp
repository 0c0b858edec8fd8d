// SPDX-License-Identifier: MIT
// A merge as a run: what its sums say, and of what it is.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/fleet/leaves.hpp"
#include "app/fleet/tree.hpp"
#include "app/run/directory.hpp"

namespace dampline::app::fleet {

struct Merged {
  std::unique_ptr<Statistics> sums;
  StateAbout about;
  Convergence history;  ///< level and stiffness over the time merged so far, in order of segments
};

/// Of leaves that are alike. Throws RunError.
[[nodiscard]] Merged merge_alike(std::span<const Leaf> leaves, const NextChunk& next);

/// What a merge is of, beside its sums: common names, first start, last end, mean rate by samples.
[[nodiscard]] StateAbout about_of(std::span<const Leaf> leaves);

/// As identify describes a record; the drift of a parameter where all is one truck's. Throws
/// RunError where the sums do not suffice: fewer than four entries, which is four light states.
[[nodiscard]] RunResult describe(const Merged& merged, std::span<const Leaf> leaves);

/// Everything of its run directory; `sources` are what was given. `notes`, and what overlaps,
/// become warnings. Throws as describe().
[[nodiscard]] RunFiles files_of(const Merged& merged, std::span<const Leaf> leaves,
                                const std::vector<std::string>& sources,
                                const std::vector<std::string>& notes);

/// segments.csv: each segment with its own level and stiffness.
[[nodiscard]] std::string segments_csv(std::span<const Leaf> leaves);

}  // namespace dampline::app::fleet
