// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <tuple>

#include "tests/estimator/record.hpp"

namespace dampline {
namespace {

constexpr std::size_t kBadAt = 15123;  // in the middle of block 25
constexpr std::int64_t kBadBlock = std::int64_t{25} * 600;

void expect_right(const Snapshot& s) {
  ASSERT_TRUE(s.valid);
  EXPECT_NEAR(s.coulomb_n.value / kLadenCoulombN, 1.0, 0.01);
  EXPECT_NEAR(s.stiffness_npm.value / kLadenStiffnessNpm, 1.0, 0.03);
}

BlockStatus status_at(const Identified& run, std::int64_t first_tick) {
  for (const BlockReport& r : run.reports) {
    if (r.first_tick == first_tick) return r.status;
  }
  ADD_FAILURE() << "no report of the block at " << first_tick;
  return BlockStatus::kUsed;
}

TEST(EstimatorFaults, ACleanRecordHasNone) {
  const Identified run = identify(laden_record());
  expect_right(run.snapshot);
  const Counts& c = run.snapshot.counts;
  EXPECT_EQ(c.samples, laden_record().size());
  EXPECT_EQ(c.gaps + c.lost + c.saturated + c.stuck + c.not_finite + c.repeated, 0U);
  EXPECT_EQ(c.blocks_excluded, 0U);
  EXPECT_EQ(c.blocks, 50U);
}

TEST(EstimatorFaults, AGapExcludesItsBlock) {
  auto record = laden_record();
  record.erase(record.begin() + kBadAt, record.begin() + kBadAt + 10);
  const Identified run = identify(record);
  expect_right(run.snapshot);
  EXPECT_EQ(run.snapshot.counts.gaps, 1U);
  EXPECT_EQ(run.snapshot.counts.lost, 10U);
  EXPECT_EQ(run.snapshot.counts.blocks_excluded, 1U);
  EXPECT_EQ(status_at(run, kBadBlock), BlockStatus::kExcludedGap);
}

TEST(EstimatorFaults, AGapOverABoundaryExcludesBothBlocks) {
  auto record = laden_record();
  record.erase(record.begin() + 15590, record.begin() + 15610);
  const Identified run = identify(record);
  expect_right(run.snapshot);
  EXPECT_EQ(run.snapshot.counts.blocks_excluded, 2U);
  EXPECT_EQ(status_at(run, kBadBlock), BlockStatus::kExcludedGap);
  EXPECT_EQ(status_at(run, kBadBlock + 600), BlockStatus::kExcludedGap);
}

// A block is excluded where one of its own samples is missing, and not where none is.
TEST(EstimatorFaults, AGapExcludesTheBlocksOfItsFirstAndOfItsLastSample) {
  for (const auto& [first, end, before, behind] :
       {std::tuple{15599, 15601, true, true}, std::tuple{15590, 15600, true, false},
        std::tuple{15599, 15600, true, false}, std::tuple{15600, 15610, false, true}}) {
    auto record = laden_record();
    record.erase(record.begin() + first, record.begin() + end);
    const Identified run = identify(record);
    EXPECT_EQ(status_at(run, kBadBlock) == BlockStatus::kExcludedGap, before) << first;
    EXPECT_EQ(status_at(run, kBadBlock + 600) == BlockStatus::kExcludedGap, behind) << end;
  }
}

/// Statistics of a quarter of a minute that is bad up to `from`, and once more at `bad`.
std::unique_ptr<Statistics> broken_at(std::size_t from, std::size_t bad) {
  const auto estimator = std::make_unique<Estimator>(EstimatorConfig{.velocity_corner_hz = 1.0});
  for (std::size_t i = 0; i < 4500; ++i) {
    Sample sample = laden_record()[i];
    if (i < from || i == bad) sample.saturated = 1;
    estimator->update(sample);
  }
  estimator->finish();
  auto out = std::make_unique<Statistics>();
  estimator->export_statistics(*out);
  return out;
}

// A stretch that is too short for a row leaves nothing behind for the next one.
TEST(EstimatorFaults, AStretchWithoutARowChangesNothing) {
  constexpr std::size_t kBad = 2000;
  const auto without = broken_at(kBad + 1, kBad);
  bool any_motion = false;
  for (std::size_t length = 100; length < kBad; length += 25) {
    const auto with = broken_at(kBad - length, kBad);
    if (with->header.counts.rows != without->header.counts.rows) break;
    any_motion = any_motion || with->header.velocity.moving > without->header.velocity.moving;
    for (std::size_t s = 0; s < kScales; ++s)
      ASSERT_EQ(with->total.factor[s].packed(), without->total.factor[s].packed()) << length;
  }
  EXPECT_TRUE(any_motion) << "long enough for velocities";
}

TEST(EstimatorFaults, SaturationExcludesItsBlock) {
  auto record = laden_record();
  for (std::size_t i = kBadAt; i < kBadAt + 5; ++i) {
    record[i].saturated = 2;
    record[i].accel_mps2[1] = 160.0;
  }
  const Identified run = identify(record);
  expect_right(run.snapshot);
  EXPECT_EQ(run.snapshot.counts.saturated, 5U);
  EXPECT_EQ(run.snapshot.counts.blocks_excluded, 1U);
  EXPECT_EQ(status_at(run, kBadBlock), BlockStatus::kExcludedSaturated);
}

TEST(EstimatorFaults, AStuckChannelExcludesItsBlock) {
  auto record = laden_record();
  for (std::size_t i = kBadAt; i < kBadAt + 200; ++i)
    record[i].accel_mps2[0] = record[kBadAt].accel_mps2[0];
  const Identified run = identify(record);
  expect_right(run.snapshot);
  EXPECT_EQ(run.snapshot.counts.stuck, 200U);
  EXPECT_EQ(run.snapshot.counts.blocks_excluded, 1U);
  EXPECT_EQ(status_at(run, kBadBlock), BlockStatus::kExcludedStuck);
}

TEST(EstimatorFaults, NotANumberExcludesItsBlockAndNeverReachesTheResult) {
  auto record = laden_record();
  record[kBadAt].accel_mps2[2] = std::numeric_limits<double>::quiet_NaN();
  record[kBadAt + 7].accel_mps2[0] = -std::numeric_limits<double>::infinity();
  const Identified run = identify(record);
  expect_right(run.snapshot);
  EXPECT_EQ(run.snapshot.counts.not_finite, 2U);
  EXPECT_EQ(run.snapshot.counts.blocks_excluded, 1U);
  EXPECT_EQ(status_at(run, kBadBlock), BlockStatus::kExcludedNotFinite);
}

TEST(EstimatorFaults, NeighboursOfABadBlockArePartialAndTheOthersWhole) {
  auto record = laden_record();
  record[kBadAt].saturated = 1;
  const Identified run = identify(record);
  for (const BlockReport& r : run.reports) {
    const std::int64_t block = r.first_tick / 600;
    // Windows and filters reach three blocks, at the ends of the record as well.
    if (block > 3 && block < 22) {
      EXPECT_EQ(r.status, BlockStatus::kUsed) << block;
    }
    if (block > 28 && block < 46) {
      EXPECT_EQ(r.status, BlockStatus::kUsed) << block;
    }
    if (block == 24 || block == 26) {
      EXPECT_EQ(r.status, BlockStatus::kPartial) << block;
    }
  }
}

TEST(EstimatorFaults, EveryBlockIsReportedOnceAndInOrder) {
  auto record = laden_record();
  record.erase(record.begin() + 9000, record.begin() + 9700);
  record[kBadAt].saturated = 1;
  const Identified run = identify(record);
  EXPECT_EQ(run.reports.size(), run.snapshot.counts.blocks);
  for (std::size_t i = 0; i < run.reports.size(); ++i) {
    EXPECT_EQ(run.reports[i].first_tick, static_cast<std::int64_t>(i) * 600);
  }
}

/// Where no row may reach, the values must not matter at all.
TEST(EstimatorFaults, NothingOfABadSampleIsUsed) {
  struct Wild {
    double a, b, c;
  };
  const auto with = [](const Wild& wild) {
    auto record = laden_record();
    for (std::size_t i = kBadAt; i < kBadAt + 20; ++i) {
      record[i].saturated = 1;
      record[i].accel_mps2 = {wild.a * static_cast<double>(i % 7), wild.b, wild.c};
    }
    return identify(record).snapshot;
  };
  const Snapshot one = with({10.0, 3.0, -2.0});
  const Snapshot other = with({-1e9, 1e12, 0.0});
  EXPECT_EQ(bits_of(one), bits_of(other));
  expect_right(one);
}

TEST(EstimatorFaults, TheKindOfNotANumberDoesNotMatter) {
  const auto with = [](double a, double b) {
    auto record = laden_record();
    for (std::size_t i = kBadAt; i < kBadAt + 20; ++i)
      record[i].accel_mps2 = {a, static_cast<double>(i) * b, a};
    return identify(record).snapshot;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(bits_of(with(nan, 1.0)), bits_of(with(infinity, -1e6)));
}

TEST(EstimatorFaults, TheValueAtWhichAChannelSticksDoesNotMatter) {
  const auto with = [](double value) {
    auto record = laden_record();
    for (std::size_t i = kBadAt; i < kBadAt + 400; ++i) record[i].accel_mps2[1] = value;
    return identify(record).snapshot;
  };
  EXPECT_EQ(bits_of(with(0.123456)), bits_of(with(-99.0)));
}

// Only the phase of the filters' low-rate part differs.
TEST(EstimatorFaults, BadSamplesHardlyChangeBlocksFarFromThem) {
  auto record = laden_record();
  record[kBadAt].saturated = 4;
  const auto config = EstimatorConfig{.memory = Memory::kWindow, .memory_s = 30.0};
  const Snapshot disturbed = identify(record, config).snapshot;
  const Snapshot clean = identify(laden_record(), config).snapshot;
  EXPECT_NEAR(disturbed.coulomb_n.value / clean.coulomb_n.value, 1.0, 2e-4);
  EXPECT_NEAR(disturbed.curve[3].force_n / clean.curve[3].force_n, 1.0, 1e-3);
}

TEST(EstimatorFaults, RepeatedAndLateSamplesAreCountedAndIgnored) {
  auto record = laden_record();
  const Snapshot clean = identify(record).snapshot;
  Sample late = record[5000];
  late.accel_mps2 = {50.0, 60.0, 70.0};
  record.insert(record.begin() + 9000, late);
  record.insert(record.begin() + 12000, record[11999]);
  const Snapshot disturbed = identify(record).snapshot;
  EXPECT_EQ(bits_of(clean), bits_of(disturbed));
  EXPECT_EQ(disturbed.counts.repeated, 2U);
  EXPECT_EQ(disturbed.counts.samples, clean.counts.samples);
}

TEST(EstimatorFaults, AGapOfDaysIsOneGap) {
  auto record = laden_record();
  constexpr std::int64_t kDays = std::int64_t{300} * 86400 * 400;
  for (std::size_t i = kBadAt; i < record.size(); ++i) record[i].tick += kDays;
  const Identified run = identify(record);
  expect_right(run.snapshot);
  EXPECT_EQ(run.snapshot.counts.gaps, 1U);
  EXPECT_EQ(run.snapshot.counts.lost, static_cast<std::uint64_t>(kDays));
  EXPECT_LE(run.snapshot.counts.blocks, 55U);
}

TEST(EstimatorFaults, AGapAtEveryBlockLeavesNoResultAndNoHang) {
  auto record = laden_record();
  for (Sample& s : record) s.tick += 5 * (s.tick / 500);
  const Snapshot s = identify(record).snapshot;
  EXPECT_FALSE(s.valid);
  EXPECT_EQ(s.counts.rows, 0U);
  EXPECT_EQ(s.counts.gaps, record.size() / 500 - 1);
}

TEST(EstimatorFaults, OneBadSampleAnywhereExcludesOneBlock) {
  for (const std::size_t at : {15000U, 15001U, 15007U, 15300U, 15598U, 15599U}) {
    auto record = laden_record();
    record[at].saturated = 1;
    const Identified run = identify(record);
    EXPECT_EQ(run.snapshot.counts.blocks_excluded, 1U) << at;
    EXPECT_EQ(status_at(run, kBadBlock), BlockStatus::kExcludedSaturated) << at;
  }
}

}  // namespace
}  // namespace dampline
