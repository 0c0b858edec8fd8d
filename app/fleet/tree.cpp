// SPDX-License-Identifier: MIT
#include "app/fleet/tree.hpp"

#include <algorithm>
#include <bit>
#include <deque>
#include <future>
#include <thread>
#include <utility>

#include "app/beside.hpp"

namespace dampline::app::fleet {

void Tree::push(Node node, const std::string& origin) {
  while (!nodes_.empty() && nodes_.back().rank == node.rank) {
    Node left = std::move(nodes_.back());
    nodes_.pop_back();
    merge_state(*left.sums, *node.sums, origin);
    node = {left.rank + 1, std::move(left.sums)};
  }
  nodes_.push_back(std::move(node));
}

std::unique_ptr<Statistics> Tree::total() const {
  auto right = std::make_unique<Statistics>(*nodes_.back().sums);
  for (std::size_t i = nodes_.size() - 1; i-- > 0;) {
    auto left = std::make_unique<Statistics>(*nodes_[i].sums);
    merge_state(*left, *right, "a merge");
    right = std::move(left);
  }
  return right;
}

std::size_t chunk_of(std::size_t leaves) {
  constexpr std::size_t kMostChunks = 240;  // rows of a run's history
  return std::bit_ceil((leaves + kMostChunks - 1) / kMostChunks);
}

std::vector<Node> merge_chunk(std::span<const Leaf> leaves) {
  Tree tree;
  for (const Leaf& leaf : leaves) {
    auto sums = std::make_unique<Statistics>();
    decode_state(leaf.read(), leaf.file.string(), *sums);
    tree.push({0, std::move(sums)}, leaf.file.string());
  }
  return tree.take();
}

int jobs_or_all(int jobs) {
  return jobs > 0 ? jobs : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

NextChunk chunks_by_threads(std::span<const Leaf> leaves, int jobs) {
  struct Working {
    std::span<const Leaf> rest;
    std::deque<std::future<std::vector<Node>>> ahead;
  };
  const auto working = std::make_shared<Working>(Working{leaves, {}});
  return [working, chunk = chunk_of(leaves.size()), jobs = static_cast<std::size_t>(jobs)] {
    while (!working->rest.empty() && working->ahead.size() < jobs) {
      const auto part = working->rest.first(std::min(chunk, working->rest.size()));
      working->ahead.push_back(beside(merge_chunk, part));
      working->rest = working->rest.subspan(part.size());
    }
    std::vector<Node> nodes = working->ahead.front().get();
    working->ahead.pop_front();
    return nodes;
  };
}

std::unique_ptr<Statistics> merge_leaves(std::span<const Leaf> leaves, const NextChunk& next,
                                         const std::function<void(const Tree&)>& after) {
  const std::size_t chunk = chunk_of(leaves.size());
  Tree tree;
  for (std::size_t done = 0; done < leaves.size(); done += chunk) {
    for (Node& node : next()) tree.push(std::move(node), leaves[done].file.string());
    if (after) after(tree);
  }
  return tree.total();
}

}  // namespace dampline::app::fleet
