// SPDX-License-Identifier: MIT
// The fixed tree over sorted segments: any number of workers, the same bytes.
#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "app/fleet/leaves.hpp"

namespace dampline::app::fleet {

/// The sums of 2^rank leaves in a row, the first of which has a number that 2^rank divides.
struct Node {
  int rank{0};
  std::unique_ptr<Statistics> sums;
};

/// The tree of n leaves: on the left the largest power of two below n, on the right the tree of the
/// rest. What is complete is joined at once, so that it holds at most log2 n + 1 nodes.
class Tree {
 public:
  /// The next leaves, a node of them. Throws RunError naming `origin` for another basis.
  /// Precondition: no node before it has a smaller rank.
  void push(Node node, const std::string& origin);
  /// All that was pushed. Precondition: something was.
  [[nodiscard]] std::unique_ptr<Statistics> total() const;
  /// What the nodes are, from the left.
  [[nodiscard]] std::vector<Node> take() { return std::move(nodes_); }

 private:
  std::vector<Node> nodes_;
};

/// How many leaves make a chunk, the work of one worker at a time: a power of two, by their number
/// alone.
[[nodiscard]] std::size_t chunk_of(std::size_t leaves);

/// The nodes of one chunk, read from the disk. Throws RunError.
[[nodiscard]] std::vector<Node> merge_chunk(std::span<const Leaf> leaves);

/// Gives the nodes of one chunk after the other. Throws RunError.
using NextChunk = std::function<std::vector<Node>()>;
/// `jobs`, or as many as the machine has processors where it is 0.
[[nodiscard]] int jobs_or_all(int jobs);
/// The leaves stay where they are until the last one was given.
[[nodiscard]] NextChunk chunks_by_threads(std::span<const Leaf> leaves, int jobs);

/// Of all leaves. `after` is called with the tree after each chunk. Throws RunError.
[[nodiscard]] std::unique_ptr<Statistics> merge_leaves(
    std::span<const Leaf> leaves, const NextChunk& next,
    const std::function<void(const Tree&)>& after = {});

}  // namespace dampline::app::fleet
