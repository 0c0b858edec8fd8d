// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <span>

#include "app/fleet/archive.hpp"
#include "app/fleet/leaves.hpp"
#include "app/fleet/tree.hpp"

namespace dampline::app::fleet {

/// The processes that work at one archive. This one is alone.
class Workers {
 public:
  Workers() = default;
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;
  virtual ~Workers() = default;

  /// Which logs this process takes.
  [[nodiscard]] virtual Part part() const { return {}; }
  [[nodiscard]] bool is_first() const { return part().part == 0; }
  /// Of all, at the first process, when all of them have come so far.
  [[nodiscard]] virtual Tally gather(const Tally& own) { return own; }
  /// The first process merges, by its own threads and the others', which are in help().
  [[nodiscard]] virtual NextChunk chunks(std::span<const Leaf> leaves, int jobs) {
    return chunks_by_threads(leaves, jobs);
  }
  /// The other processes, until the first one has its merge.
  virtual void help() {}
};

}  // namespace dampline::app::fleet
