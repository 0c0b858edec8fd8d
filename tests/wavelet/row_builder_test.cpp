// SPDX-License-Identifier: MIT
#include "dampline/wavelet/row_builder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "tests/wavelet/bump.hpp"

namespace dampline {
namespace {

constexpr double kRateHz = 300.0;

/// Random samples, kept whole beside the builder's rings.
class RowBuilderOnNoise : public testing::Test {
 protected:
  RowBuilderOnNoise() : builder_{std::make_unique<RowBuilder>(kRateHz)} {}

  void push() {
    const auto n = static_cast<std::int64_t>(frame_.size());
    frame_.push_back(noise_(random_));
    relative_.push_back(noise_(random_));
    LawColumns::Lanes law;
    for (int i = 0; i < LawColumns::kLanes; ++i) law[i] = static_cast<float>(noise_(random_));
    law_.push_back(LawColumns::values(law));
    turn_spring_.push_back(double{law[kTurnSpringLane]});
    turn_push_.push_back(double{law[kTurnPushLane]});
    still_.push_back(noise_(random_) > 0.8);
    builder_->set_accelerations(n, frame_.back(), relative_.back());
    builder_->set_law(n, law, still_.back());
  }

  /// The row as it is defined, by loops over everything.
  [[nodiscard]] GalerkinRow naive_row(std::size_t scale, std::int64_t centre) const {
    const int half = builder_->bank().half(scale);
    const int reach = half + 1;
    const auto b = [&](int order, int n) {
      return static_cast<double>(bump_derivative(order, static_cast<long double>(n) / reach));
    };
    double energy = 0.0;
    for (int n = -half; n <= half; ++n) energy += b(4, n) * b(4, n);
    const double norm = 1.0 / std::sqrt(energy);
    const double tau_s = reach / kRateHz;
    const auto at = [](const std::vector<double>& x, std::int64_t n) {
      return x[static_cast<std::size_t>(n)];
    };
    const auto smooth = [&](const std::vector<double>& x, std::int64_t n) {
      return (at(x, n - 1) + 10.0 * at(x, n) + at(x, n + 1)) / 12.0;
    };
    GalerkinRow row = GalerkinRow::Zero();
    for (int n = -half; n <= half; ++n) {
      const auto i = static_cast<std::size_t>(centre + n);
      for (int c = 0; c < LawColumns::kCount; ++c) row[c] += norm * b(4, n) * law_[i][c];
      row[kStiffnessColumn] += norm * tau_s * tau_s * b(2, n) * smooth(relative_, centre + n);
      row[kViscousColumn] -= norm * tau_s * b(3, n) * smooth(relative_, centre + n);
      row[kTargetColumn] -= norm * b(4, n) * smooth(frame_, centre + n);
      row[kStiffnessColumn] += norm * b(4, n) * turn_spring_[i];
      row[kTargetColumn] -= norm * b(4, n) * turn_push_[i];
    }
    return row;
  }

  [[nodiscard]] double naive_still_share(std::size_t scale, std::int64_t centre) const {
    const int half = builder_->bank().half(scale);
    double still = 0.0;
    double all = 0.0;
    for (int n = -half; n <= half; ++n) {
      const auto psi = static_cast<double>(
          std::abs(bump_derivative(4, static_cast<long double>(n) / (half + 1))));
      all += psi;
      if (still_[static_cast<std::size_t>(centre + n)]) still += psi;
    }
    return still / all;
  }

  std::unique_ptr<RowBuilder> builder_;
  std::vector<double> frame_, relative_;
  std::vector<double> turn_spring_, turn_push_;  // in single precision in the builder
  std::vector<LawColumns::Values> law_;
  std::vector<bool> still_;
  std::mt19937_64 random_{8};
  std::normal_distribution<double> noise_;
};

TEST_F(RowBuilderOnNoise, GivesTheRowOfItsDefinitionAlsoAfterTheRingsWrapAround) {
  int rows = 0;
  for (int n = 0; n < 5000; ++n) {
    push();
    if (n % 61 != 0) continue;
    for (std::size_t s = 0; s < kScales; ++s) {
      const std::int64_t centre = n - builder_->bank().half(s) - 1;
      if (centre < builder_->bank().half(s) + 1) continue;
      const GalerkinRow difference = builder_->row(s, centre) - naive_row(s, centre);
      ASSERT_LT(std::abs(difference[kViscousColumn]), 1e-12) << s << " at " << centre;
      ASSERT_LT(difference.tail<3>().cwiseAbs().maxCoeff(), 2e-6) << s << " at " << centre;
      // A sum in single precision of numbers around 1.
      ASSERT_LT(difference.head<LawColumns::kCount>().cwiseAbs().maxCoeff(), 2e-6) << s;
      ++rows;
    }
  }
  EXPECT_GT(rows, 300);
}

TEST_F(RowBuilderOnNoise, WeighsStandstillByTheRow) {
  for (int n = 0; n < 2000; ++n) push();
  for (std::size_t s = 0; s < kScales; ++s) {
    const std::int64_t centre = 1999 - builder_->bank().half(s);
    EXPECT_NEAR(builder_->still_share(s, centre), naive_still_share(s, centre), 1e-12);
  }
}

TEST_F(RowBuilderOnNoise, StandstillIsAllOrNothingWhereItIsAllOrNothing) {
  for (int n = 0; n < 1200; ++n) {
    builder_->set_law(n, LawColumns::Lanes::Zero(), n >= 600);
    if (n != 599 && n != 1199) continue;
    for (std::size_t s = 0; s < kScales; ++s) {
      const double share = builder_->still_share(s, n - builder_->bank().half(s));
      EXPECT_NEAR(share, n >= 600 ? 1.0 : 0.0, 1e-12);
    }
  }
}

}  // namespace
}  // namespace dampline
