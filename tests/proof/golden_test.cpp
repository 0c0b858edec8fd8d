// SPDX-License-Identifier: MIT
#include "tests/proof/golden.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>

#include "dampline/damping/estimator.hpp"
#include "tests/proof/ride.hpp"

namespace dampline::proof {
namespace {

const char* const kPath = DAMPLINE_SOURCE_DIR "/tests/proof/golden/laden_ride.txt";

/// What 120 s of a laden ride end in.
Figures identify_ride() {
  const auto identifier = std::make_unique<Estimator>(EstimatorConfig{});
  for (const Sample& sample : laden_ride(120.0)) static_cast<void>(identifier->update(sample));
  identifier->finish();
  return figures_of(identifier->snapshot());
}

Figures committed() {
  std::ifstream file{kPath};
  return read_figures({std::istreambuf_iterator<char>{file}, {}});
}

/// The same bits on every compiler. A change of the algorithm shows as a change of the committed
/// file. To write it anew:
///   DAMPLINE_WRITE_GOLDEN=1 build/release/tests/test_proof --gtest_filter='GoldenRun.*'
TEST(GoldenRun, EndsInTheCommittedFigures) {
  const Figures figures = identify_ride();
  std::cout << "hash of the figures: " << std::hex << hash_figures(figures) << std::dec << "\n";
  if (std::getenv("DAMPLINE_WRITE_GOLDEN") != nullptr)
    std::ofstream{kPath} << write_figures(figures);
  const Figures golden = committed();
  ASSERT_EQ(figures.size(), golden.size()) << "in " << kPath;
  for (std::size_t i = 0; i < figures.size(); ++i) {
    EXPECT_EQ(figures[i].first, golden[i].first);
    EXPECT_EQ(figures[i].second, golden[i].second) << figures[i].first;
  }
}

TEST(GoldenFile, KeepsEveryBit) {
  const Figures figures{{"third", 1.0 / 3.0}, {"tiny", 5e-324}, {"minus_zero", -0.0}};
  EXPECT_EQ(read_figures(write_figures(figures)), figures);
  EXPECT_TRUE(std::signbit(read_figures(write_figures(figures)).back().second));
}

TEST(GoldenHash, ChangesWithTheLastBitOfOneFigure) {
  EXPECT_NE(hash_figures({{"force_n", 1.0}}),
            hash_figures({{"force_n", std::nextafter(1.0, 2.0)}}));
}

}  // namespace
}  // namespace dampline::proof
