// SPDX-License-Identifier: MIT
#include "published/oscillator/block_memory.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <random>
#include <vector>

#include "tests/dense.hpp"

namespace dampline {
namespace {

constexpr int kColumns = 4;
using Stored = Eigen::Matrix<double, Eigen::Dynamic, kColumns>;
using Factor = Information<kColumns>;
const Eigen::Vector3d kTruth{2.0, -0.5, 30.0};

/// One block of rows: A theta + noise.
Stored random_block(std::mt19937_64& random, int rows = 40, double noise = 0.1) {
  std::normal_distribution<double> normal;
  Stored out(rows, kColumns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < 3; ++j) out(i, j) = normal(random);
    out(i, 3) = out.row(i).head<3>().dot(kTruth) + noise * normal(random);
  }
  return out;
}

Factor factor_of(const Stored& rows) {
  Factor factor;
  for (int i = 0; i < rows.rows(); ++i) factor.absorb(rows.row(i).transpose());
  return factor;
}

/// Batch least squares over weighted blocks.
Eigen::Vector3d batch(const std::vector<Stored>& blocks, const std::vector<double>& weight) {
  Eigen::MatrixXd all(0, kColumns);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    if (weight[b] == 0.0) continue;
    Eigen::MatrixXd more(all.rows() + blocks[b].rows(), kColumns);
    more << all, std::sqrt(weight[b]) * blocks[b];
    all = more;
  }
  return test::least_squares(all.leftCols(3), all.col(3));
}

template <int Entries>
void expect_batch(const BlockMemory<kColumns, Entries>& memory, const std::vector<Stored>& blocks,
                  const std::vector<double>& weight, double tolerance) {
  const auto estimate = memory.estimate();
  ASSERT_TRUE(estimate.ok());
  const Eigen::Vector3d truth = batch(blocks, weight);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(estimate.value().value[static_cast<std::size_t>(i)], truth[i],
                tolerance * std::abs(truth[i]));
  }
}

TEST(BlockMemory, WithInfiniteMemoryIsTheBatch) {
  std::mt19937_64 random{1};
  BlockMemory<kColumns, 8> memory;
  std::vector<Stored> blocks;
  for (int b = 0; b < 37; ++b) {  // merges neighbours twice
    blocks.push_back(random_block(random));
    memory.add(factor_of(blocks.back()), 40.0);
    if (b >= 3) expect_batch(memory, blocks, std::vector<double>(blocks.size(), 1.0), 1e-12);
  }
  EXPECT_EQ(memory.blocks(), 37);
  EXPECT_EQ(memory.estimate().value().blocks, 37);
  EXPECT_NEAR(memory.estimate().value().residual_rms, 0.1, 0.01);
}

// Efron and Stein 1981, by fits that lack one block each.
TEST(BlockMemory, StatesTheDeviationOfTheJackknife) {
  constexpr int kBlocks = 8;
  std::mt19937_64 random{12};
  BlockMemory<kColumns, kBlocks> memory;
  std::vector<Stored> blocks;
  for (int b = 0; b < kBlocks; ++b) {
    blocks.push_back(random_block(random, 40, 3.0));
    memory.add(factor_of(blocks.back()), 40.0);
  }
  std::vector<Eigen::Vector3d> without;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t left = 0; left < blocks.size(); ++left) {
    std::vector<double> weight(blocks.size(), 1.0);
    weight[left] = 0.0;
    without.push_back(batch(blocks, weight));
    mean += without.back() / kBlocks;
  }
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& theta : without) squares += (theta - mean).cwiseAbs2();
  const auto estimate = memory.estimate();
  ASSERT_TRUE(estimate.ok());
  for (int i = 0; i < 3; ++i) {
    const double jackknife = std::sqrt(squares[i] * (kBlocks - 1) / kBlocks);
    EXPECT_NEAR(estimate.value().std[static_cast<std::size_t>(i)] / jackknife,
                short_record_factor(kBlocks), 0.01);
  }
}

TEST(BlockMemory, WithAWindowIsTheBatchOfTheNewestBlocks) {
  std::mt19937_64 random{2};
  BlockMemory<kColumns, 8> memory{{.memory = Memory::kWindow, .memory_blocks = 6.0}};
  std::vector<Stored> blocks;
  for (int b = 0; b < 30; ++b) {
    blocks.push_back(random_block(random));
    memory.add(factor_of(blocks.back()), 40.0);
    std::vector<double> weight(blocks.size(), 0.0);
    for (std::size_t i = blocks.size() > 6 ? blocks.size() - 6 : 0; i < blocks.size(); ++i) {
      weight[i] = 1.0;
    }
    if (b >= 3) expect_batch(memory, blocks, weight, 1e-12);
  }
  EXPECT_EQ(memory.blocks(), 6);
}

TEST(BlockMemory, LetsALongWindowSlideByGroupsOfBlocks) {
  std::mt19937_64 random{3};
  BlockMemory<kColumns, 8> memory{{.memory = Memory::kWindow, .memory_blocks = 20.0}};
  for (int b = 0; b < 100; ++b) memory.add(factor_of(random_block(random)), 40.0);
  EXPECT_GE(memory.blocks(), 15);
  EXPECT_LE(memory.blocks(), 20);
}

TEST(BlockMemory, WithForgettingWeighsBlocksByTheirAge) {
  std::mt19937_64 random{4};
  BlockMemory<kColumns, 8> memory{{.memory = Memory::kForgetting, .memory_blocks = 5.0}};
  std::vector<Stored> blocks;
  for (int b = 0; b < 30; ++b) {
    blocks.push_back(random_block(random));
    memory.add(factor_of(blocks.back()), 40.0);
  }
  std::vector<double> weight;
  for (int b = 0; b < 30; ++b) weight.push_back(std::exp((b - 29) / 5.0));
  expect_batch(memory, blocks, weight, 1e-12);
}

TEST(BlockMemory, PartsMergedAreTheWhole) {
  std::mt19937_64 random{5};
  BlockMemory<kColumns, 8> whole;
  BlockMemory<kColumns, 8> first;
  BlockMemory<kColumns, 8> second;
  for (int b = 0; b < 21; ++b) {
    const Factor factor = factor_of(random_block(random));
    whole.add(factor, 40.0);
    (b < 9 ? first : second).add(factor, 40.0);
  }
  first.merge(second);
  EXPECT_EQ(first.blocks(), 21);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(first.estimate().value().value[i], whole.estimate().value().value[i], 1e-12);
  }
}

/// The deviation without its widening for few blocks and its floor, which is small here.
TEST(BlockMemory, StatesADeviationThatIsThatOfTheScatter) {
  std::mt19937_64 random{6};
  std::array<double, 3> square{};
  std::array<double, 3> stated{};
  constexpr int kRuns = 300;
  constexpr int kBlocks = 24;
  for (int run = 0; run < kRuns; ++run) {
    BlockMemory<kColumns> memory;
    for (int b = 0; b < kBlocks; ++b) {
      // blocks of unequal noise, as a moving car has them
      memory.add(factor_of(random_block(random, 20, b % 3 == 0 ? 3.0 : 1.0)), 20.0);
    }
    const auto estimate = memory.estimate().value();
    for (std::size_t i = 0; i < 3; ++i) {
      const double error = estimate.value[i] - kTruth[static_cast<int>(i)];
      square[i] += error * error / kRuns;
      stated[i] += estimate.std[i] * estimate.std[i] / kRuns;
    }
  }
  const double widening = short_record_factor(kBlocks);
  for (std::size_t i = 0; i < 3; ++i) {
    const double ratio = std::sqrt(stated[i] / square[i]) / widening;
    EXPECT_GT(ratio, 0.9) << i;
    EXPECT_LT(ratio, 1.25) << i;  // the jackknife errs upwards (Efron and Stein)
  }
}

TEST(BlockMemory, SaysNothingOfWhatTheDataDoNotDetermine) {
  std::mt19937_64 random{7};
  BlockMemory<kColumns> memory;
  for (int b = 0; b < 10; ++b) {
    Stored rows = random_block(random);
    rows.col(1) = 2.0 * rows.col(0);
    memory.add(factor_of(rows), 40.0);
  }
  EXPECT_EQ(memory.estimate().error(), Errc::kNotReady);
  memory.clear();
  EXPECT_EQ(memory.blocks(), 0);
}

}  // namespace
}  // namespace dampline
