// SPDX-License-Identifier: MIT
#include "app/fleet/tree.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <random>

namespace dampline::app::fleet {
namespace {

std::unique_ptr<Statistics> leaf(std::size_t number) {
  std::mt19937_64 random{number};
  std::normal_distribution<double> normal;
  auto out = std::make_unique<Statistics>();
  out->header.entry_count = 1 + static_cast<std::uint32_t>(number % 3);
  for (std::size_t i = 0; i < out->header.entry_count; ++i) {
    ScaleFactors& entry = out->entries[i];
    for (auto& factor : entry.factor)
      for (double& x : factor.packed()) x = normal(random);
    entry.rows.fill(7.0);
    entry.blocks = 1;
    out->total.merge(entry);
  }
  out->header.velocity.sum_squares = normal(random);
  return out;
}

/// As the document of the tree says it, word for word.
std::unique_ptr<Statistics> tree_of(std::size_t begin, std::size_t end) {
  if (end - begin == 1) return leaf(begin);
  const std::size_t left = std::bit_floor(end - begin - 1);
  auto out = tree_of(begin, begin + left);
  merge_state(*out, *tree_of(begin + left, end), "the right");
  return out;
}

TEST(Tree, IsTheOneOfTheDocument) {
  for (const std::size_t leaves : {1U, 2U, 3U, 5U, 8U, 13U, 31U, 40U}) {
    Tree tree;
    for (std::size_t i = 0; i < leaves; ++i) tree.push({0, leaf(i)}, "a leaf");
    EXPECT_TRUE(encode_state(*tree.total()) == encode_state(*tree_of(0, leaves))) << leaves;
  }
}

TEST(Tree, IsTheSameOfChunks) {
  constexpr std::size_t kLeaves = 43;
  const std::string expected = encode_state(*tree_of(0, kLeaves));
  for (const std::size_t chunk : {1U, 2U, 4U, 16U, 64U}) {
    Tree whole;
    for (std::size_t begin = 0; begin < kLeaves; begin += chunk) {
      Tree part;
      for (std::size_t i = begin; i < std::min(begin + chunk, kLeaves); ++i)
        part.push({0, leaf(i)}, "a leaf");
      for (Node& node : part.take()) whole.push(std::move(node), "a chunk");
    }
    EXPECT_TRUE(encode_state(*whole.total()) == expected) << chunk;
  }
}

TEST(Tree, HasChunksByTheNumberOfLeavesAlone) {
  EXPECT_EQ(chunk_of(1), 1U);
  EXPECT_EQ(chunk_of(240), 1U);
  EXPECT_EQ(chunk_of(241), 2U);
  EXPECT_EQ(chunk_of(10000), 64U);
}

}  // namespace
}  // namespace dampline::app::fleet
