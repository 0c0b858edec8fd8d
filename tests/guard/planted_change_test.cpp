// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <tuple>
#include <vector>

#include "dampline/basis/columns.hpp"
#include "dampline/guard/parameter_drift.hpp"
#include "tests/estimate/random_rows.hpp"

namespace dampline {
namespace {

constexpr double kPlantedEntryS = 20.0;

/// Rows of a truck whose law has the width of column 5, made entry by entry: all entries have the
/// same motion, each its own noise.
class Planted {
 public:
  struct Truck {
    double friction{1.0};    ///< over the usual one
    double stiffness{1.0};   ///< the same
    double deflection{1.0};  ///< the same
  };
  explicit Planted(double noise, std::uint64_t seed = 1, int rows = 100)
      : noise_{noise}, random_{seed} {
    std::mt19937_64 motion{77};
    std::normal_distribution<double> normal;
    for (int i = 0; i < rows; ++i) motion_.push_back({0.02 * normal(motion), normal(motion)});
  }
  /// `blocks` into the newest entry, which is merged into the total.
  void add(const Truck& truck, std::uint32_t blocks = 10) {
    static const LawColumns law{kDefaultCurveNodesMps};
    entries_.push_back(std::make_unique<ScaleFactors>());
    ScaleFactors& entry = *entries_.back();
    for (std::size_t i = 0; i < motion_.size(); ++i) {
      const std::size_t scale = i % kScales;
      GalerkinRow row = GalerkinRow::Zero();
      row.head<LawColumns::kCount>() = law(motion_[i].velocity_mps);
      row[kStiffnessColumn] = truck.deflection * motion_[i].deflection;
      row[kViscousColumn] = motion_[i].velocity_mps;
      row[kTargetColumn] = kFriction * truck.friction * row[5] +
                           kStiffness * truck.stiffness * row[kStiffnessColumn] +
                           noise_ * normal_(random_);
      entry.factor[scale].absorb(row);
      entry.rows[scale] += 1.0;
    }
    entry.blocks = blocks;
    total_->merge(entry);
  }
  void add(int entries, const Truck& truck) {
    for (int i = 0; i < entries; ++i) add(truck);
  }
  [[nodiscard]] ParameterDrift drift(double entry_s = kPlantedEntryS) const {
    std::vector<const ScaleFactors*> list;
    for (const auto& entry : entries_) list.push_back(entry.get());
    return find_parameter_drift(*total_, EntryList{list.data(), list.size()}, entry_s);
  }
  [[nodiscard]] const ScaleFactors& total() const { return *total_; }

  static constexpr double kFriction = 0.2;
  static constexpr double kStiffness = 0.3;

 private:
  struct Moment {
    double velocity_mps, deflection;
  };
  double noise_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::vector<Moment> motion_;
  std::vector<std::unique_ptr<ScaleFactors>> entries_;
  std::unique_ptr<ScaleFactors> total_{std::make_unique<ScaleFactors>()};
};
using Truck = Planted::Truck;

struct Change {
  Truck truck;
  DriftingParameter parameter;
  double change;
};
const std::array kChanges{
    Change{{.friction = 1.1}, DriftingParameter::kFriction, 0.1},
    Change{{.friction = 0.8}, DriftingParameter::kFriction, -0.2},
    Change{{.stiffness = 1.2}, DriftingParameter::kStiffness, 0.2},
    Change{{.stiffness = 0.9}, DriftingParameter::kStiffness, -0.1},
    Change{{.friction = 0.8, .stiffness = 0.8}, DriftingParameter::kMass, 0.25},
    Change{{.friction = 1.25, .stiffness = 1.25}, DriftingParameter::kMass, -0.2}};

TEST(PlantedChange, IsNamedWithItsEntryAndSize) {
  for (const Change& planted : kChanges) {
    for (const int after : {2, 7, 13, 18}) {
      Planted record{0.002};
      record.add(after, {});
      record.add(20 - after, planted.truck);
      const ParameterDrift drift = record.drift();
      EXPECT_TRUE(drift.judged);
      EXPECT_TRUE(drift.found);
      EXPECT_TRUE(drift.step);
      EXPECT_EQ(drift.parameter, planted.parameter) << planted.change;
      EXPECT_EQ(drift.time_s, after * kPlantedEntryS);
      EXPECT_EQ(drift.interval_s, kPlantedEntryS);
      EXPECT_NEAR(drift.change.value, planted.change, 0.01);
      EXPECT_GT(drift.gain, 0.85);
    }
  }
}

// From 0 to the whole change, which is that at the end.
TEST(PlantedChange, IsNamedWhereItIsSlow) {
  for (const Change& planted : kChanges) {
    Planted record{0.002};
    for (int i = 0; i < 20; ++i) {
      const double part = (i + 0.5) / 20.0;
      record.add({.friction = 1.0 + part * (planted.truck.friction - 1.0),
                  .stiffness = 1.0 + part * (planted.truck.stiffness - 1.0)});
    }
    const ParameterDrift drift = record.drift();
    EXPECT_TRUE(drift.found);
    EXPECT_FALSE(drift.step);
    EXPECT_EQ(drift.time_s, 0.0);
    EXPECT_EQ(drift.parameter, planted.parameter) << planted.change;
    EXPECT_NEAR(drift.change.value, planted.change, 0.01);
  }
}

// 3 %, and 6 % more for each factor e by which the deflection differs.
TEST(PlantedChange, IsNamedFromALeastSizeOn) {
  for (const auto& [deflection, friction, found] :
       {std::tuple{1.0, 1.027, false}, std::tuple{1.0, 1.033, true}, std::tuple{1.0, 0.973, false},
        std::tuple{1.0, 0.967, true}, std::tuple{std::exp(1.0), 1.085, false},
        std::tuple{std::exp(1.0), 1.095, true}, std::tuple{std::exp(-1.0), 1.085, false},
        std::tuple{std::exp(-1.0), 1.095, true}}) {
    Planted record{0.0002};
    record.add(8, {});
    record.add(12, {.friction = friction, .deflection = deflection});
    EXPECT_EQ(record.drift().found, found) << deflection << ", " << friction;
  }
}

TEST(PlantedChange, NeedsTenEntriesAndTwoOnEitherSide) {
  for (const auto& [entries, judged] : {std::pair{9, false}, std::pair{10, true}}) {
    Planted record{0.002};
    record.add(entries - 4, {});
    record.add(4, {.friction = 1.2});
    EXPECT_EQ(record.drift().judged, judged) << entries;
    EXPECT_EQ(record.drift().found, judged) << entries;
  }
  Planted first{0.002};  // a step after one entry is taken for one after two
  first.add(1, {});
  first.add(19, {.friction = 1.2});
  EXPECT_NE(first.drift().time_s, kPlantedEntryS);
  Planted last{0.002};
  last.add(19, {});
  last.add(1, {.friction = 1.2});
  EXPECT_NE(last.drift().time_s, 19 * kPlantedEntryS);
}

// An entry of one block has no friction and spring of its own: there the error alone tells.
TEST(PlantedChange, IsNamedByTheErrorOrByTheEntriesOwnSteps) {
  for (const auto& [noise, gain_is_enough] : {std::pair{0.07, true}, std::pair{0.11, false}}) {
    Planted record{noise, 1, 500};
    record.add(14, {});
    record.add(14, {.friction = 1.15});
    const ParameterDrift drift = record.drift(3.1);
    EXPECT_EQ(drift.gain > 0.025, gain_is_enough) << drift.gain;
    EXPECT_TRUE(drift.found);
    EXPECT_GT(drift.friction_significance, 6.0);
    EXPECT_LT(drift.stiffness_significance, 4.0);
    EXPECT_EQ(record.drift(2.9).found, gain_is_enough);
  }
}

/// Root of the mean of (change - planted)^2 over the stated variance.
double error_over_deviation(const Change& planted) {
  constexpr int kRecords = 40;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= kRecords; ++seed) {
    Planted record{0.02, seed};
    record.add(10, {});
    record.add(10, planted.truck);
    const ParameterDrift drift = record.drift();
    sum += std::pow((drift.change.value - planted.change) / drift.change.std, 2);
  }
  return std::sqrt(sum / kRecords);
}

TEST(PlantedChange, ErrsByItsDeviation) {
  for (const std::size_t which : {1U, 2U, 4U}) {
    const double ratio = error_over_deviation(kChanges[which]);
    EXPECT_GT(ratio, 0.65) << which;
    EXPECT_LT(ratio, 1.2) << which;
  }
}

TEST(PlantedChange, OfNothingIsNotNamed) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Planted record{0.02, seed};
    record.add(20, {});
    EXPECT_TRUE(record.drift().judged);
    EXPECT_FALSE(record.drift().found) << seed;
  }
}

// 150 blocks fix the law; from then on every 30 make a group.
TEST(PlantedGroups, AreMeasuredEachByItself) {
  Planted record{0.0005};
  GroupMeter meter;
  GroupMeter::Group group;
  EXPECT_EQ(meter.due(), 150U);
  for (int i = 0; i < 14; ++i) record.add({});
  EXPECT_FALSE(meter.update(record.total(), group));
  EXPECT_EQ(meter.due(), 150U) << "140 blocks";
  record.add({});
  EXPECT_FALSE(meter.update(record.total(), group)) << "the law alone";
  std::uint32_t due = 180;
  for (const auto& [friction, stiffness] :
       {std::pair{1.0, 1.0}, std::pair{1.3, 1.0}, std::pair{1.0, 0.7}, std::pair{0.5, 1.5}}) {
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(meter.due(), due);
      EXPECT_FALSE(meter.update(record.total(), group)) << "too early";
      record.add({.friction = friction, .stiffness = stiffness});
    }
    ASSERT_TRUE(meter.update(record.total(), group));
    EXPECT_NEAR(group.friction_mps2 / Planted::kFriction, friction, 0.005);
    EXPECT_NEAR(group.stiffness_ps2 / Planted::kStiffness, stiffness, 0.005);
    due += 30;
  }
}

}  // namespace
}  // namespace dampline
