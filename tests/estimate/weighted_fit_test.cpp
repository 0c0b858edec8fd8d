// SPDX-License-Identifier: MIT
#include "dampline/estimate/weighted_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <utility>
#include <vector>

namespace dampline {
namespace {

constexpr int kUnknowns = 2;
using Fit = WeightedFit<kUnknowns>;
constexpr double kForce = 0.5;
constexpr double kStiffness = 80.0;
constexpr std::array<double, kScales> kSigma{0.3, 0.1, 0.03, 0.1, 0.3};

ColumnMap<kUnknowns> force_and_stiffness() {
  ColumnMap<kUnknowns> map = ColumnMap<kUnknowns>::Zero();
  map(4, 0) = 1.0;
  map(kStiffnessColumn, 1) = 1.0;
  map(kTargetColumn, 2) = 1.0;
  return map;
}

/// Rows of t = F X_F + k X_k + noise of the scale's own size; X_k is some hundredths.
class Synthetic {
 public:
  explicit Synthetic(std::uint64_t seed) : random_{seed} {}

  GalerkinRow row(double noise) {
    GalerkinRow out = GalerkinRow::Zero();
    out[4] = normal_(random_);
    out[kStiffnessColumn] = 0.01 * normal_(random_);
    out[kTargetColumn] = kForce * out[4] + kStiffness * out[kStiffnessColumn] + noise;
    return out;
  }
  double normal() { return normal_(random_); }
  void add(ScaleFactors& to, int rows) {
    for (std::size_t s = 0; s < kScales; ++s) {
      for (int i = 0; i < rows; ++i) {
        to.factor[s].absorb(row(kSigma[s] * normal()));
        to.rows[s] += 1.0;
      }
    }
    ++to.blocks;
  }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

TEST(MappedColumns, AreTheProductWithTheWholeMap) {
  Synthetic data{3};
  ScaleFactors factors;
  data.add(factors, 40);
  ColumnMap<3> map = ColumnMap<3>::Zero();
  map(4, 0) = 1.0;
  map(5, 0) = 0.5;
  map(3, 0) = -0.25;
  map(kStiffnessColumn, 1) = 2.0;
  map(kTargetColumn, 3) = 1.0;  // the third unknown has no column
  const MappedColumns<3> columns{map};
  for (int i = 0; i < kRowColumns; ++i) {
    const Eigen::Matrix<double, 4, 1> whole = map.transpose() * factors.factor[1].row(i);
    EXPECT_LT((columns.row_of(factors.factor[1], i) - whole).norm(), 1e-15 * (1.0 + whole.norm()));
  }
}

TEST(WeightedFit, RecoversTheTruthWhereScalesDifferInTheirNoise) {
  Synthetic data{1};
  ScaleFactors factors;
  data.add(factors, 2000);
  const Fit fit = weighted_fit<kUnknowns>(factors, force_and_stiffness(), kAllScales);
  ASSERT_TRUE(fit.ok);
  EXPECT_NEAR(fit.theta[0], kForce, 4.0 * std::sqrt(fit.inverse(0, 0)));
  EXPECT_NEAR(fit.theta[1], kStiffness, 4.0 * std::sqrt(fit.inverse(1, 1)));
  EXPECT_LT(std::sqrt(fit.inverse(0, 0)), 0.001);
}

TEST(WeightedFit, WeighsEachScaleByItsOwnResidualVariance) {
  Synthetic data{2};
  ScaleFactors factors;
  data.add(factors, 4000);
  const Fit fit = weighted_fit<kUnknowns>(factors, force_and_stiffness(), kAllScales);
  for (std::size_t s = 0; s < kScales; ++s)
    EXPECT_NEAR(fit.weight[s] * kSigma[s] * kSigma[s], 1.0, 0.1) << s;
}

TEST(WeightedFit, BeatsOneScaleAloneAndStatesItsScatter) {
  double all = 0.0;
  double one = 0.0;
  double stated = 0.0;
  constexpr int kRuns = 200;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    Synthetic data{seed};
    ScaleFactors factors;
    data.add(factors, 60);
    const auto map = force_and_stiffness();
    const Fit fit = weighted_fit<kUnknowns>(factors, map, kAllScales);
    const Fit noisy = weighted_fit<kUnknowns>(factors, map, {true, true, false, true, true});
    all += std::pow(fit.theta[1] - kStiffness, 2) / kRuns;
    one += std::pow(noisy.theta[1] - kStiffness, 2) / kRuns;
    stated += fit.inverse(1, 1) / kRuns;
  }
  EXPECT_LT(all, 0.4 * one);
  EXPECT_NEAR(stated / all, 1.0, 0.35);
}

/// Twenty entries whose target is in another unit.
std::vector<ScaleFactors> entries_in(double unit) {
  Synthetic data{9};
  std::vector<ScaleFactors> entries(20);
  for (ScaleFactors& entry : entries) {
    for (std::size_t s = 0; s < kScales; ++s) {
      for (int i = 0; i < 30; ++i) {
        GalerkinRow row = data.row(kSigma[s] * data.normal());
        row[kTargetColumn] *= unit;
        entry.factor[s].absorb(row);
        entry.rows[s] += 1.0;
      }
    }
    entry.blocks = 1;
  }
  return entries;
}

struct FitOfEntries {
  Fit fit;
  Eigen::Matrix2d covariance;
  double nmse;
};
FitOfEntries fit_of(const std::vector<ScaleFactors>& entries) {
  ScaleFactors total;
  std::vector<const ScaleFactors*> list;
  for (const ScaleFactors& entry : entries) {
    total.merge(entry);
    list.push_back(&entry);
  }
  const auto map = force_and_stiffness();
  const Fit fit = weighted_fit<kUnknowns>(total, map, kAllScales);
  return {fit, score_covariance<kUnknowns>(fit, EntryList{list}, map),
          held_out_nmse_of<kUnknowns, 5>(fit, EntryList{list}, map)};
}

// N or kN, m or mm: what is identified is the same.
TEST(WeightedFit, KnowsNoUnits) {
  const FitOfEntries in_one = fit_of(entries_in(1.0));
  for (const double unit : {1e-3, 1e3}) {
    const FitOfEntries out = fit_of(entries_in(unit));
    ASSERT_TRUE(out.fit.ok);
    EXPECT_LT((out.fit.theta / unit - in_one.fit.theta).norm(), 1e-9 * in_one.fit.theta.norm());
    for (std::size_t s = 0; s < kScales; ++s)
      EXPECT_NEAR(out.fit.weight[s] * unit * unit / in_one.fit.weight[s], 1.0, 1e-9) << s;
    EXPECT_NEAR(out.fit.weighted_residual / in_one.fit.weighted_residual, 1.0, 1e-9);
    EXPECT_NEAR(out.fit.weighted_total / in_one.fit.weighted_total, 1.0, 1e-9);
    EXPECT_LT((out.covariance / (unit * unit) - in_one.covariance).norm(),
              1e-9 * in_one.covariance.norm());
    EXPECT_NEAR(out.nmse / in_one.nmse, 1.0, 1e-9);
  }
}

TEST(WeightedFit, VisitsTheRowsOfScalesAndGroupsThatHaveAWeight) {
  const MappedColumns<kUnknowns> columns{force_and_stiffness()};
  const auto visits = [&](const std::array<double, kScales>& weight, const auto& entry) {
    Fit fit;
    fit.weight = weight;
    int count = 0;
    for_each_row(fit, entry, columns, [&](double /*weight*/, const auto& /*row*/) { ++count; });
    return count / kRowColumns;
  };
  EXPECT_EQ(visits({1e-6, 0.0, 1e-9, 0.0, 1e6}, ScaleFactors{}), 3);
  EXPECT_EQ(visits({0.0, 0.0, 0.0, 0.0, 0.0}, ScaleFactors{}), 0);
  EXPECT_EQ(visits({1e-6, 1.0, 1.0, 1.0, 1e-6}, GroupedFactors{}), 2);
  EXPECT_EQ(visits({1e-6, 1.0, 1.0, 1.0, 0.0}, GroupedFactors{}), 1);
  EXPECT_EQ(visits({0.0, 1.0, 1.0, 1.0, 1e-6}, GroupedFactors{}), 1);
}

TEST(WeightedFit, LeavesOutMaskedScalesAndScalesWithFewRows) {
  Synthetic data{3};
  ScaleFactors factors;
  data.add(factors, 100);
  factors.rows[3] = 5.0 * kUnknowns - 1.0;
  const Fit fit =
      weighted_fit<kUnknowns>(factors, force_and_stiffness(), {true, false, true, true, true});
  ASSERT_TRUE(fit.ok);
  EXPECT_EQ(fit.weight[1], 0.0);
  EXPECT_EQ(fit.weight[3], 0.0);
  EXPECT_GT(fit.weight[0], 0.0);
}

TEST(WeightedFit, UsesAScaleFromFiveRowsAnUnknownOn) {
  Synthetic data{8};
  ScaleFactors factors;
  data.add(factors, 100);
  factors.rows[3] = 10.0;
  factors.rows[4] = 9.99;
  const Fit fit = weighted_fit<kUnknowns>(factors, force_and_stiffness(), kAllScales);
  EXPECT_GT(fit.weight[3], 0.0);
  EXPECT_EQ(fit.weight[4], 0.0);
}

TEST(WeightedFit, LeavesOutAScaleThatShowsNothing) {
  Synthetic data{8};
  ScaleFactors factors;
  data.add(factors, 100);
  factors.factor[2].clear();
  const Fit fit = weighted_fit<kUnknowns>(factors, force_and_stiffness(), kAllScales);
  const Fit masked =
      weighted_fit<kUnknowns>(factors, force_and_stiffness(), {true, true, false, true, true});
  ASSERT_TRUE(fit.ok);
  EXPECT_EQ(fit.weight[2], 0.0);
  EXPECT_EQ(fit.theta, masked.theta);
}

// sum n log s^2, sum w |r|^2 and sum w |t|^2, with r by the rows themselves.
TEST(WeightedFit, StatesItsObjectiveAndWhatIsLeft) {
  Synthetic data{9};
  ScaleFactors factors;
  std::array<std::vector<GalerkinRow>, kScales> rows;
  for (std::size_t s = 0; s < kScales; ++s) {
    for (int i = 0; i < 200; ++i) {
      rows[s].push_back(data.row(kSigma[s] * data.normal()));
      factors.factor[s].absorb(rows[s].back());
      factors.rows[s] += 1.0;
    }
  }
  const Fit fit = weighted_fit<kUnknowns>(factors, force_and_stiffness(), kAllScales);
  double objective = 0.0, residual = 0.0, total = 0.0;
  Fit::Square information = Fit::Square::Zero();
  for (std::size_t s = 0; s < kScales; ++s) {
    double left = 0.0, target = 0.0;
    Fit::Square gram = Fit::Square::Zero();
    for (const GalerkinRow& row : rows[s]) {
      const Fit::Vector x{row[4], row[kStiffnessColumn]};
      left += std::pow(row[kTargetColumn] - fit.theta.dot(x), 2);
      target += row[kTargetColumn] * row[kTargetColumn];
      gram += x * x.transpose();
    }
    EXPECT_NEAR(fit.weight[s] * left, 200.0, 1e-6) << "a variance of one";
    objective += 200.0 * std::log(left / 200.0);
    residual += fit.weight[s] * left;
    total += fit.weight[s] * target;
    information += fit.weight[s] * gram;
  }
  EXPECT_NEAR(fit.objective, objective, 1e-6);
  EXPECT_NEAR(fit.weighted_residual / residual, 1.0, 1e-5);
  EXPECT_NEAR(fit.weighted_total / total, 1.0, 1e-5);
  EXPECT_LT((fit.inverse * information - Fit::Square::Identity()).norm(), 1e-4);
}

TEST(ShortRecordFactor, FallsFromFourToOne) {
  for (const auto& [count, factor] :
       {std::pair{0.0, 4.0}, std::pair{3.5, 4.0}, std::pair{4.0, 4.0}, std::pair{5.0, 2.5},
        std::pair{6.0, 2.0}, std::pair{28.0, 1.12}, std::pair{303.0, 1.01}})
    EXPECT_NEAR(short_record_factor(count), factor, 1e-12) << count;
}

TEST(WeightedFit, SaysWhenThereIsNothingToFit) {
  EXPECT_FALSE(weighted_fit<kUnknowns>(ScaleFactors{}, force_and_stiffness(), kAllScales).ok);
  Synthetic data{4};
  ScaleFactors factors;
  data.add(factors, 100);
  ColumnMap<kUnknowns> same = force_and_stiffness();
  same.col(1) = same.col(0);
  EXPECT_FALSE(weighted_fit<kUnknowns>(factors, same, kAllScales).ok);
}

TEST(WeightedFit, APriorDecidesWhatTheDataDoNot) {
  Synthetic data{5};
  ScaleFactors factors;
  data.add(factors, 100);
  ColumnMap<kUnknowns> blind = force_and_stiffness();
  blind(kStiffnessColumn, 1) = 0.0;
  Information<kUnknowns + 1> prior;
  Information<kUnknowns + 1>::Row row = Information<kUnknowns + 1>::Row::Zero();
  row[1] = 10.0;  // 7 with a deviation of 0.1
  row[2] = 70.0;
  prior.absorb(row);
  const Fit fit = weighted_fit<kUnknowns>(factors, blind, kAllScales, prior);
  ASSERT_TRUE(fit.ok);
  EXPECT_NEAR(fit.theta[1], 7.0, 1e-9);
}

/// Blocks whose noise is shared within the block and, a little, with the next one: the plain
/// (X'X)^-1 would be far too small.
struct Covered {
  double by_scores{0.0};
  double by_rows{0.0};
};
Covered coverage(std::size_t blocks, int runs) {
  Covered covered;
  const auto map = force_and_stiffness();
  for (int run = 0; run < runs; ++run) {
    Synthetic data{static_cast<std::uint64_t>(1000 + run)};
    std::vector<ScaleFactors> entries(blocks);
    ScaleFactors total;
    double last = data.normal();
    for (ScaleFactors& entry : entries) {
      const double now = data.normal();
      const double shared = now + 0.25 * last;
      last = now;
      for (int i = 0; i < 20; ++i) {
        for (std::size_t s = 0; s < kScales; ++s) {
          GalerkinRow row = data.row(kSigma[s] * data.normal());
          row[kTargetColumn] += 20.0 * shared * row[kStiffnessColumn];
          entry.factor[s].absorb(row);
          entry.rows[s] += 1.0;
        }
      }
      entry.blocks = 1;
      for (std::size_t s = 0; s < kScales; ++s) {
        total.factor[s].merge(entry.factor[s]);
        total.rows[s] += entry.rows[s];
      }
    }
    std::vector<const ScaleFactors*> list;
    list.reserve(entries.size());
    for (const ScaleFactors& entry : entries) list.push_back(&entry);
    const Fit fit = weighted_fit<kUnknowns>(total, map, kAllScales);
    const auto covariance = score_covariance<kUnknowns>(fit, EntryList{list}, map);
    const double error = std::abs(fit.theta[1] - kStiffness);
    const double factor = short_record_factor(static_cast<double>(blocks));
    if (error < 2.0 * factor * std::sqrt(covariance(1, 1))) covered.by_scores += 1.0 / runs;
    if (error < 2.0 * std::sqrt(fit.inverse(1, 1))) covered.by_rows += 1.0 / runs;
  }
  return covered;
}

TEST(ScoreCovariance, CoversTheTruthAsOftenAsItSaysForCorrelatedBlocks) {
  for (const std::size_t blocks : {14U, 28U}) {
    const Covered covered = coverage(blocks, 400);
    EXPECT_GE(covered.by_scores, 0.90) << blocks;
    EXPECT_LE(covered.by_scores, 0.99) << blocks;
    EXPECT_LT(covered.by_rows, 0.75) << "rows that are taken for independent cover less";
  }
}

TEST(HeldOutNmse, IsTheNoisesShareAndNotLessThanTheFittedError) {
  Synthetic data{6};
  std::vector<ScaleFactors> entries(20);
  ScaleFactors total;
  for (ScaleFactors& entry : entries) {
    data.add(entry, 30);
    for (std::size_t s = 0; s < kScales; ++s) {
      total.factor[s].merge(entry.factor[s]);
      total.rows[s] += entry.rows[s];
    }
  }
  std::vector<const ScaleFactors*> list;
  list.reserve(entries.size());
  for (const ScaleFactors& entry : entries) list.push_back(&entry);
  const auto map = force_and_stiffness();
  const Fit fit = weighted_fit<kUnknowns>(total, map, kAllScales);
  const double held_out = held_out_nmse_of<kUnknowns, 5>(fit, EntryList{list}, map);
  EXPECT_GE(held_out, fit.weighted_residual / fit.weighted_total);
  // t has F^2 + (0.01 k)^2 = 0.89 of signal; per scale sigma^2 of noise, weights 1 / sigma^2.
  double weighted_signal = 0.0;
  for (const double sigma : kSigma) weighted_signal += 0.89 / (sigma * sigma);
  EXPECT_NEAR(held_out, kScales / (kScales + weighted_signal), 0.1 * held_out);
}

// Entries of grouped rows, each weighed before, say what entries of single scales say.
TEST(GroupedFactors, TellWhatTheirScalesTell) {
  Synthetic data{10};
  const auto map = force_and_stiffness();
  const MappedColumns<kUnknowns> columns{map};
  ScaleFactors total;
  std::vector<ScaleFactors> entries(20);
  for (ScaleFactors& entry : entries) {
    data.add(entry, 30);
    total.merge(entry);
  }
  const Fit fit = weighted_fit<kUnknowns>(total, map, kAllScales);
  std::vector<GroupedFactors> grouped(entries.size());
  std::vector<const ScaleFactors*> list;
  std::vector<const GroupedFactors*> grouped_list;
  for (std::size_t b = 0; b < entries.size(); ++b) {
    for (std::size_t s = 0; s < kScales; ++s) {
      EXPECT_EQ(group_of(s), s + 1 == kScales ? 1U : 0U);
      for (int i = 0; i < kRowColumns; ++i) {
        const GalerkinRow row = std::sqrt(fit.weight[s]) * entries[b].factor[s].row(i);
        grouped[b].factor[group_of(s)].absorb(row.cast<float>());
      }
    }
    const auto gram = weighted_gram<kUnknowns>(fit, entries[b], columns);
    EXPECT_LT((weighted_gram<kUnknowns>(fit, grouped[b], columns) - gram).norm(),
              1e-4 * gram.norm());
    const Fit::Vector score = score_of<kUnknowns>(fit, entries[b], columns);
    EXPECT_LT((score_of<kUnknowns>(fit, grouped[b], columns) - score).norm(), 1e-2 * score.norm());
    list.push_back(&entries[b]);
    grouped_list.push_back(&grouped[b]);
  }
  const double of_scales = held_out_nmse_of<kUnknowns, 5>(fit, EntryList{list}, map);
  EXPECT_NEAR((held_out_nmse_of<kUnknowns, 5>(fit, GroupedList{grouped_list}, map)) / of_scales,
              1.0, 1e-3);
  const auto covariance = score_covariance<kUnknowns>(fit, EntryList{list}, map);
  const auto of_groups = score_covariance<kUnknowns>(fit, GroupedList{grouped_list}, map);
  EXPECT_LT((of_groups - covariance).norm(), 1e-2 * covariance.norm());
}

}  // namespace
}  // namespace dampline
