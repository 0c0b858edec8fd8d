// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>

#include "dampline/damping/estimator.hpp"
#include "tests/proof/heap_hook.hpp"
#include "tests/proof/ride.hpp"

namespace dampline::proof {
namespace {

#ifdef DAMPLINE_IS_RELEASE
constexpr std::int64_t kSamples = 2'000'000;
#else
constexpr std::int64_t kSamples = 200'000;
#endif

/// The ride over and over.
class EndlessRide {
 public:
  Sample next() noexcept {
    Sample sample = ride_[position_];
    position_ = (position_ + 1) % ride_.size();
    trouble_.apply(sample);
    return sample;
  }

 private:
  std::vector<Sample> ride_{laden_ride(300.0)};
  std::size_t position_{0};
  Trouble trouble_{10};
};

class IdentifierHeap : public testing::TestWithParam<Memory> {};

TEST_P(IdentifierHeap, IsNotTouchedByMillionsOfSamplesAndTheirSnapshots) {
  EndlessRide ride;
  EstimatorConfig config;
  config.memory = GetParam();
  config.memory_s = config.memory == Memory::kInfinite ? 0.0 : 120.0;
  ASSERT_TRUE(Estimator::check(config).ok());
  const auto identifier = std::make_unique<Estimator>(config);
  Snapshot last;
  std::uint64_t calls = 0;
  {
    const HeapWatch watch;
    for (std::int64_t i = 0; i < kSamples; ++i) {
      static_cast<void>(identifier->update(ride.next()));
      if (i % 50'000 == 0) last = identifier->snapshot();
    }
    identifier->finish();
    last = identifier->snapshot();
    calls = HeapWatch::calls();
  }
  EXPECT_EQ(calls, 0U);
  EXPECT_TRUE(last.valid);  // it did what it is for, and left out what it must
  EXPECT_GT(last.counts.blocks_excluded, 0U);
  EXPECT_GT(last.counts.gaps, 0U);
  EXPECT_GT(last.counts.not_finite, 0U);
}

INSTANTIATE_TEST_SUITE_P(EveryMemory, IdentifierHeap,
                         testing::Values(Memory::kInfinite, Memory::kWindow, Memory::kForgetting));

}  // namespace
}  // namespace dampline::proof
