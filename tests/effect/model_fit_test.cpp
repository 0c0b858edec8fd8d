// SPDX-License-Identifier: MIT
#include "dampline/effect/model_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <utility>
#include <vector>

namespace dampline::effect {
namespace {

constexpr double kLevel = 0.2;
constexpr double kSpring = 140.0;
constexpr double kDamping = 3.0;

/// Entries of rows whose columns are white, but for the signs, which are smooth ones of one
/// velocity; the force is friction of a width, a spring, and damping.
class PlantedRows {
 public:
  explicit PlantedRows(double noise, std::uint64_t seed = 1, double width_mps = 2.0e-3)
      : noise_{noise}, width_mps_{width_mps}, random_{seed} {}
  Row row() {
    Row out = Row::Zero();
    const double velocity_mps = 0.02 * normal_(random_);
    for (std::size_t i = 0; i < kWidths; ++i)
      out[kSign + at(i)] = std::erf(0.886226925452758 * velocity_mps / kWidthMps[i]);
    const double deflection_m = 1e-3 * normal_(random_);
    for (const Regressor& of : {stiffness_regressor(), viscous_regressor()}) {
      const double value =
          of.column[0] == stiffness_regressor().column[0] ? deflection_m : velocity_mps;
      spread(of, value, out);
    }
    out[kTarget] = kLevel * std::erf(0.886226925452758 * velocity_mps / width_mps_) +
                   kSpring * deflection_m + kDamping * velocity_mps + noise_ * normal_(random_);
    return out;
  }
  void fill(GramStore& store, int blocks, int rows) {
    for (int block = 0; block < blocks; ++block) {
      for (int i = 0; i < rows; ++i) {
        for (std::size_t s = 0; s < kScales; ++s) {
          rows_[s].push_back(row());
          store.absorb(block, s, rows_[s].back());
        }
      }
      store.close(block);
      store.finish();
    }
  }
  [[nodiscard]] const std::vector<Row>& rows(std::size_t scale) const { return rows_[scale]; }

 private:
  /// The regressor's value, by its first two columns in halves.
  static void spread(const Regressor& of, double value, Row& out) {
    const auto parts = static_cast<double>(of.count);
    for (std::size_t p = 0; p < of.count; ++p) out[of.column[p]] = value / parts / of.weight[p];
  }
  double noise_;
  double width_mps_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::array<std::vector<Row>, kScales> rows_;
};

Model with_damping() {
  Candidate viscous{.effect = Effect::kViscous, .sign = 1, .count = 1};
  viscous.regressor[0] = viscous_regressor();
  return Model{}.with(viscous);
}

struct Fitted {
  explicit Fitted(double noise, int blocks = 20, std::uint64_t seed = 1, double width_mps = 2.0e-3)
      : planted{noise, seed, width_mps} {
    planted.fill(*store, blocks, 40);
    ok = evidence->load(*store);
  }
  [[nodiscard]] ModelFit fit(const Model& model) const {
    return std::make_unique<ModelFitter>(*evidence)->fit(model);
  }
  PlantedRows planted;
  std::unique_ptr<GramStore> store{std::make_unique<GramStore>()};
  std::unique_ptr<Evidence> evidence{std::make_unique<Evidence>()};
  bool ok{false};
};

TEST(Evidence, WeighsScalesByTheirTargetsAndLeavesOutTheSmall) {
  const auto store = std::make_unique<GramStore>();
  PlantedRows planted{0.1};
  std::array<double, kScales> squares{};
  constexpr std::array<int, kScales> kRows{99, 100, 200, 300, 0};
  for (std::size_t s = 0; s < kScales; ++s) {
    for (int i = 0; i < kRows[s]; ++i) {
      const Row row = planted.row();
      squares[s] += row[kTarget] * row[kTarget];
      store->absorb(i % 2, s, row);
    }
  }
  for (const std::int64_t block : {0, 1}) store->close(block);
  store->finish();
  const auto evidence = std::make_unique<Evidence>();
  ASSERT_TRUE(evidence->load(*store));
  EXPECT_EQ(evidence->count, 2U);
  double total = 0.0;
  for (std::size_t s = 0; s < kScales; ++s) {
    EXPECT_EQ(evidence->rows[s], kRows[s]);
    const bool used = s == 1 || s == 2 || s == 3;
    if (used) total += kRows[s];
    EXPECT_NEAR(evidence->weight[s], used ? kRows[s] / squares[s] : 0.0, 1e-9 * kRows[s]) << s;
  }
  EXPECT_NEAR(evidence->total.at(kTarget, kTarget), total, 1e-6) << "each scale's rows";
  EXPECT_NEAR(evidence->entry[0].at(kTarget, kTarget) + evidence->entry[1].at(kTarget, kTarget),
              total, 1e-6);
  EXPECT_FALSE(std::make_unique<Evidence>()->load(*std::make_unique<GramStore>()));
}

TEST(ModelFitter, FindsWhatWasPlanted) {
  const Fitted data{0.01};
  ASSERT_TRUE(data.ok);
  const ModelFit fit = data.fit(with_damping());
  ASSERT_TRUE(fit.ok);
  EXPECT_EQ(fit.terms, 4);
  EXPECT_EQ(kWidthMps[fit.width_index], 2.0e-3);
  EXPECT_NEAR(fit.width_mps, 2.0e-3, 0.1e-3);
  EXPECT_NEAR(fit.theta[ModelFit::kCoulomb], kLevel, 0.002);
  EXPECT_NEAR(fit.theta[ModelFit::kStiffness], kSpring, 0.6);
  EXPECT_NEAR(fit.theta[ModelFit::kFirstEffect], kDamping, 0.06);
  EXPECT_EQ(base_of(fit).coulomb, fit.theta[ModelFit::kCoulomb]);
  EXPECT_EQ(base_of(fit).stiffness, fit.theta[ModelFit::kStiffness]);
  EXPECT_LT(fit.nmse, 0.2 * data.fit({}).nmse) << "without the damping";
  for (const double width_mps : {0.75e-3, 1.6e-3, 7.5e-3})
    EXPECT_NEAR(Fitted(0.003, 20, 2, width_mps).fit(with_damping()).width_mps / width_mps, 1.0,
                0.12);
}

// By the rows themselves: what is left, each scale weighted; and the weights that belong to it.
TEST(ModelFitter, StatesWhatIsLeftOfTheRows) {
  const Fitted data{0.05};
  const Model model = with_damping();
  const ModelFit fit = data.fit(model);
  const auto fitter = std::make_unique<ModelFitter>(*data.evidence);
  const ScaleWeights own = fitter->weights_of(model, fit);
  double left = 0.0, target = 0.0;
  for (std::size_t s = 0; s < kScales; ++s) {
    double of_scale = 0.0;
    for (const Row& row : data.planted.rows(s)) {
      of_scale += std::pow(row[kTarget] - ModelFitter::force(model, fit, row), 2);
      target += data.evidence->weight[s] * row[kTarget] * row[kTarget];
    }
    left += data.evidence->weight[s] * of_scale;
    EXPECT_NEAR(own[s] * of_scale, 800.0, 1e-3) << s;
  }
  EXPECT_NEAR(fit.nmse, left / target, 1e-9);
  EXPECT_NEAR(fitter->nmse_of(model, fit), fit.nmse, 1e-12);
  ModelFit other = fit;
  other.theta[ModelFit::kStiffness] = 0.0;
  EXPECT_GT(fitter->nmse_of(model, other), 2.0 * fit.nmse);
}

// Each entry by those that are neither in its fold nor beside one of it: two of five folds.
TEST(ModelFitter, HoldsOutAFoldAndItsNeighbours) {
  const Fitted data{0.05};
  const Model model = with_damping();
  const ModelFit fit = data.fit(model);
  double sum = 0.0;
  for (std::size_t e = 0; e < 20; ++e) {
    const auto rest = std::make_unique<GramStore>();
    std::int64_t block = 0;
    const auto rows_of = [&](std::size_t entry, const auto& visit) {
      for (std::size_t s = 0; s < kScales; ++s)
        for (std::size_t i = 40 * entry; i < 40 * (entry + 1); ++i)
          visit(s, data.planted.rows(s)[i]);
    };
    for (std::size_t other = 0; other < 20; ++other) {
      const std::size_t apart = (other + 5 - e % 5) % 5;
      if (apart == 0 || apart == 1 || apart == 4) continue;
      rows_of(other, [&](std::size_t s, const Row& row) { rest->absorb(block, s, row); });
      rest->close(block++);
      rest->finish();
    }
    const auto evidence = std::make_unique<Evidence>();
    ASSERT_TRUE(evidence->load(*rest));
    evidence->weigh(*rest, data.evidence->weight);
    const ModelFit part = std::make_unique<ModelFitter>(*evidence)->fit(model);
    double left = 0.0;
    rows_of(e, [&](std::size_t s, const Row& row) {
      left += data.evidence->weight[s] *
              std::pow(row[kTarget] - ModelFitter::force(model, part, row), 2);
    });
    EXPECT_NEAR(fit.held_out_error[e] * data.evidence->total.at(kTarget, kTarget), left,
                1e-6 * left)
        << e;
    sum += fit.held_out_error[e];
  }
  EXPECT_NEAR(fit.held_out_nmse, sum, 1e-12);
}

TEST(ModelFitter, ErrsByItsDeviation) {
  double squares = 0.0;
  constexpr int kRecords = 40;
  for (std::uint64_t seed = 1; seed <= kRecords; ++seed) {
    const ModelFit fit = Fitted{0.05, 20, seed}.fit(with_damping());
    squares += std::pow(fit.theta[ModelFit::kStiffness] - kSpring, 2) /
               fit.covariance(ModelFit::kStiffness, ModelFit::kStiffness) / kRecords;
  }
  EXPECT_GT(squares, 0.5);
  EXPECT_LT(squares, 2.0);
}

TEST(Model, TakesEffectsInAndOut) {
  Candidate a{.effect = Effect::kViscous};
  Candidate b{.effect = Effect::kBumpStop};
  Candidate c{.effect = Effect::kBacklash};
  const Model all = Model{}.with(a).with(b).with(c);
  ASSERT_EQ(all.count, 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const Model less = all.without(i);
    ASSERT_EQ(less.count, 2U);
    EXPECT_EQ(less.effect[0].effect, i == 0 ? Effect::kBumpStop : Effect::kViscous);
    EXPECT_EQ(less.effect[1].effect, i == 2 ? Effect::kBumpStop : Effect::kBacklash);
  }
}

}  // namespace
}  // namespace dampline::effect
