// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numeric>

#include "dampline/damping/summary.hpp"
#include "dampline/estimate/merge.hpp"
#include "tests/estimator/record.hpp"

namespace dampline {
namespace {

TEST(Estimator, DoesNotDependOnWhereTheTicksBegin) {
  // A multiple of the block's length and of every stride.
  const WindowBank bank{300.0};
  std::int64_t shift = 600;
  for (std::size_t s = 0; s < kScales; ++s)
    shift = std::lcm(shift, static_cast<std::int64_t>(bank.stride(s)));
  auto record = laden_record();
  for (Sample& s : record) s.tick += 3 * shift;
  EXPECT_EQ(bits_of(identify(record).snapshot), bits_of(identify(laden_record()).snapshot));
}

TEST(Estimator, HardlyDependsOnAnyOtherShift) {
  auto record = laden_record();
  for (Sample& s : record) s.tick += 317;
  const Snapshot a = identify(record).snapshot;
  const Snapshot b = identify(laden_record()).snapshot;
  EXPECT_NEAR(a.coulomb_n.value / b.coulomb_n.value, 1.0, 0.002);
  EXPECT_NE(bits_of(a), bits_of(b));
}

TEST(Estimator, LookingDoesNotChangeWhatComesLater) {
  const auto looking = [](Estimator& identifier, std::size_t i) {
    if (i % 411 == 17) static_cast<void>(identifier.snapshot());
  };
  EXPECT_EQ(bits_of(identify(laden_record(), {}, looking).snapshot),
            bits_of(identify(laden_record()).snapshot));
}

TEST(Estimator, LookingTwiceShowsTheSame) {
  const auto identifier = std::make_unique<Estimator>(EstimatorConfig{});
  for (const Sample& s : laden_record()) identifier->update(s);
  EXPECT_EQ(bits_of(identifier->snapshot()), bits_of(identifier->snapshot()));
}

TEST(Estimator, FinishingTwiceIsFinishingOnce) {
  const auto identifier = std::make_unique<Estimator>(EstimatorConfig{});
  for (const Sample& s : laden_record()) identifier->update(s);
  identifier->finish();
  const Snapshot once = identifier->snapshot();
  identifier->finish();
  const Snapshot twice = identifier->snapshot();
  EXPECT_EQ(bits_of(once), bits_of(twice));
  EXPECT_EQ(once.counts.blocks, twice.counts.blocks);
  EXPECT_EQ(once.counts.rows, twice.counts.rows);
}

TEST(Estimator, FinishingBeforeAnySampleIsHarmless) {
  const auto identifier = std::make_unique<Estimator>(EstimatorConfig{});
  identifier->finish();
  EXPECT_FALSE(identifier->snapshot().valid);
  BlockReport report;
  EXPECT_FALSE(identifier->next_report(report));
}

TEST(Estimator, IsNotFooledByABiasOfASensor) {
  auto record = laden_record();
  for (Sample& s : record) {
    s.accel_mps2[0] += 0.2;
    s.accel_mps2[1] -= 0.3;
    s.accel_mps2[2] += 0.3;
  }
  const Snapshot biased = identify(record).snapshot;
  const Snapshot clean = identify(laden_record()).snapshot;
  EXPECT_NEAR(biased.coulomb_n.value / clean.coulomb_n.value, 1.0, 1e-3);
  EXPECT_NEAR(biased.stiffness_npm.value / clean.stiffness_npm.value, 1.0, 1e-3);
  EXPECT_NEAR(biased.velocity_rms_mps / clean.velocity_rms_mps, 1.0, 1e-6);
}

/// Gravity is on every sensor: y'' does not see it.
TEST(Estimator, DoesNotSeeGravity) {
  auto record = laden_record();
  for (Sample& s : record) {
    for (double& a : s.accel_mps2) a += 9.81;
  }
  const Snapshot with = identify(record).snapshot;
  const Snapshot without = identify(laden_record()).snapshot;
  EXPECT_NEAR(with.coulomb_n.value / without.coulomb_n.value, 1.0, 1e-3);
  EXPECT_NEAR(with.stiffness_npm.value / without.stiffness_npm.value, 1.0, 1e-3);
}

TEST(Estimator, HardlyMindsADrift) {
  auto record = laden_record();
  for (Sample& s : record) s.accel_mps2[1] += 0.01 * static_cast<double>(s.tick) / 300.0;
  const Snapshot drifting = identify(record).snapshot;
  const Snapshot clean = identify(laden_record()).snapshot;
  EXPECT_NEAR(drifting.coulomb_n.value / clean.coulomb_n.value, 1.0, 1e-3);
  EXPECT_NEAR(drifting.stiffness_npm.value / clean.stiffness_npm.value, 1.0, 1e-3);
}

TEST(Estimator, TheWheelsetsAreInterchangeable) {
  auto record = laden_record();
  for (Sample& s : record) std::swap(s.accel_mps2[1], s.accel_mps2[2]);
  const Snapshot swapped = identify(record).snapshot;
  const Snapshot plain = identify(laden_record()).snapshot;
  EXPECT_NEAR(swapped.coulomb_n.value / plain.coulomb_n.value, 1.0, 1e-10);
}

TEST(Estimator, IsOddInTheMotion) {
  auto record = laden_record();
  for (Sample& s : record) {
    for (double& a : s.accel_mps2) a = -a;
  }
  const Snapshot mirrored = identify(record).snapshot;
  const Snapshot plain = identify(laden_record()).snapshot;
  EXPECT_NEAR(mirrored.coulomb_n.value / plain.coulomb_n.value, 1.0, 1e-10);
  EXPECT_EQ(mirrored.curve[2].samples, plain.samples_negative[2]);
}

TEST(Estimator, ForcesScaleWithTheMovingMass) {
  EstimatorConfig heavy;
  heavy.moving_mass_kg = 3.0 * EstimatorConfig{}.moving_mass_kg;
  const Snapshot a = identify(laden_record()).snapshot;
  const Snapshot b = identify(laden_record(), heavy).snapshot;
  EXPECT_NEAR(b.coulomb_n.value / a.coulomb_n.value, 3.0, 1e-12);
  EXPECT_NEAR(b.stiffness_npm.value / a.stiffness_npm.value, 3.0, 1e-12);
  EXPECT_NEAR(b.viscous_nspm.value / a.viscous_nspm.value, 3.0, 1e-12);
  EXPECT_NEAR(b.curve[4].force_n / a.curve[4].force_n, 3.0, 1e-12);
  EXPECT_EQ(b.law_width_mps.value, a.law_width_mps.value);
}

TEST(Estimator, EveryRowIsInTheStatisticsOnce) {
  const auto identifier = std::make_unique<Estimator>(EstimatorConfig{});
  for (const Sample& s : laden_record()) identifier->update(s);
  identifier->finish();
  const auto statistics = std::make_unique<Statistics>();
  identifier->export_statistics(*statistics);
  double total = 0.0;
  double entries = 0.0;
  for (std::size_t s = 0; s < kScales; ++s) {
    total += statistics->total.rows[s];
    for (const ScaleFactors& e : statistics->entries) entries += e.rows[s];
  }
  EXPECT_EQ(total, static_cast<double>(statistics->header.counts.rows));
  EXPECT_EQ(entries, total);
}

TEST(Estimator, TwoHalvesMergeToTheWhole) {
  const auto whole = std::make_unique<Statistics>();
  const auto first = std::make_unique<Statistics>();
  const auto second = std::make_unique<Statistics>();
  const auto one = std::make_unique<Estimator>(EstimatorConfig{});
  const auto parted = std::make_unique<Estimator>(EstimatorConfig{});
  for (std::size_t i = 0; i < laden_record().size(); ++i) {
    if (i == 12345) {
      parted->export_statistics(*first);
      parted->clear_statistics();
    }
    one->update(laden_record()[i]);
    parted->update(laden_record()[i]);
  }
  one->finish();
  parted->finish();
  one->export_statistics(*whole);
  parted->export_statistics(*second);
  ASSERT_TRUE(merge(*first, *second).ok());
  for (std::size_t s = 0; s < kScales; ++s) {
    const auto truth = whole->total.factor[s].gram();
    EXPECT_LT((first->total.factor[s].gram() - truth).norm() / truth.norm(), 1e-12);
    EXPECT_EQ(first->total.rows[s], whole->total.rows[s]);
  }
  EXPECT_EQ(first->total.blocks, whole->total.blocks);
  EXPECT_EQ(first->header.counts.samples, whole->header.counts.samples);
  EXPECT_EQ(first->header.counts.blocks, whole->header.counts.blocks);
  EXPECT_EQ(first->header.counts.rows, whole->header.counts.rows);
  EXPECT_EQ(first->header.velocity.moving, whole->header.velocity.moving);
  const SummaryConfig config{.moving_mass_kg = kLadenMassKg};
  const Snapshot a = summarise(*first, config);
  const Snapshot b = summarise(*whole, config);
  EXPECT_NEAR(a.coulomb_n.value / b.coulomb_n.value, 1.0, 1e-10);
  EXPECT_NEAR(a.stiffness_npm.value / b.stiffness_npm.value, 1.0, 1e-10);
  EXPECT_NEAR(a.law_width_mps.value / b.law_width_mps.value, 1.0, 1e-8);
  for (std::size_t i = 0; i < kCurveSegments; ++i) {
    EXPECT_NEAR(a.curve[i].force_n / b.curve[i].force_n, 1.0, 1e-9);
    EXPECT_EQ(a.curve[i].samples, b.curve[i].samples);
  }
  // The groups of blocks differ a little, so the deviations do.
  EXPECT_NEAR(a.coulomb_n.std / b.coulomb_n.std, 1.0, 0.5);
}

TEST(Estimator, StatisticsOfAnotherBasisAreRefused) {
  const auto header_of = [](const EstimatorConfig& config) {
    const auto out = std::make_unique<Statistics>();
    const auto identifier = std::make_unique<Estimator>(config);
    identifier->export_statistics(*out);
    return out->header.basis_hash;
  };
  const std::uint64_t plain = header_of({});
  EXPECT_EQ(plain, 0x70413cc9050578e7U) << "states of earlier runs would no longer merge";
  EXPECT_EQ(plain, header_of({.moving_mass_kg = 1000.0})) << "the mass is no part of the basis";
  EXPECT_NE(plain, header_of({.sample_rate_hz = 200.0}));
  EXPECT_NE(plain, header_of({.sample_rate_hz = 300.001})) << "windows of as many samples";
  EXPECT_NE(plain, header_of({.velocity_corner_hz = 1.0}));
  EXPECT_NE(plain, header_of({.anti_alias = {.corner_hz = 90.0}}));
  EstimatorConfig nodes;
  nodes.curve_nodes_mps[3] += 1e-6;
  EXPECT_NE(plain, header_of(nodes));
}

}  // namespace
}  // namespace dampline
