// SPDX-License-Identifier: MIT
#include "published/wavelet/terms.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <type_traits>

#include "published/wavelet/models.hpp"

namespace dampline {
namespace {

TEST(Terms, AreWhatTheirNamesSay) {
  EXPECT_DOUBLE_EQ(Viscous{}(2.0, 3.0), 3.0);
  EXPECT_DOUBLE_EQ(Spring{}(2.0, 3.0), 2.0);
  EXPECT_DOUBLE_EQ(CubicSpring{}(-2.0, 3.0), -8.0);
  EXPECT_DOUBLE_EQ(VanDerPolDamper{}(2.0, -3.0), -12.0);
  EXPECT_DOUBLE_EQ((Power<0, 0>{}(2.0, 3.0)), 1.0);
  EXPECT_DOUBLE_EQ((Power<3, 2>{}(2.0, -3.0)), 72.0);
  EXPECT_DOUBLE_EQ(Friction<>{}(2.0, -3.0), -1.0);
  EXPECT_DOUBLE_EQ(ProgressiveFriction<>{}(-2.0, -3.0), -2.0);
  const ExponentialFriction<> teflon{.rate_spm = 23.6};
  EXPECT_DOUBLE_EQ(teflon(0.0, -0.1), -std::exp(-2.36));
}

TEST(Signs, OfMostaghelAndDavisHaveTheirSlopeAtRestAndTheirLimit) {
  const auto check = [](auto sign, double slope) {
    EXPECT_NEAR((sign(1e-9) - sign(-1e-9)) / 2e-9, slope, 1e-5 * slope);
    EXPECT_NEAR(sign(1e6), 1.0, 1e-8);
    EXPECT_NEAR(sign(-1e6), -1.0, 1e-8);
    EXPECT_DOUBLE_EQ(sign(0.0), 0.0);
  };
  check(TanhSign{.sharpness_spm = 150.0}, 150.0);
  check(ErfSign{.sharpness_spm = 150.0}, 150.0 * 2.0 / std::sqrt(M_PI));
  check(AtanSign{.sharpness_spm = 150.0}, 150.0 * 2.0 / M_PI);
  check(RationalSign{.sharpness_spm = 150.0}, 150.0);
  check(RootSign{.width_mps = 0.01}, 100.0);
}

TEST(Signs, AtOneOverTheSharpness) {
  EXPECT_DOUBLE_EQ(TanhSign{.sharpness_spm = 50.0}(0.02), std::tanh(1.0));
  EXPECT_DOUBLE_EQ(ErfSign{.sharpness_spm = 50.0}(0.02), std::erf(1.0));
  EXPECT_DOUBLE_EQ(AtanSign{.sharpness_spm = 50.0}(0.02), 0.5);
  EXPECT_DOUBLE_EQ(RationalSign{.sharpness_spm = 50.0}(0.02), 0.5);
  EXPECT_DOUBLE_EQ(RootSign{.width_mps = 0.02}(0.02), std::sqrt(0.5));
}

TEST(Signs, ExactOneIsZeroAtRest) {
  EXPECT_EQ(ExactSign{}(0.0), 0.0);
  EXPECT_EQ(ExactSign{}(1e-300), 1.0);
  EXPECT_EQ(ExactSign{}(-1e-300), -1.0);
}

struct Cubic {
  double factor;
};
double cubic_speed(double x, double v, const void* context) noexcept {
  return static_cast<const Cubic*>(context)->factor * x * v * v * v;
}

TEST(UserTerm, IsCalledWithItsContext) {
  const Cubic cubic{4.0};
  const UserTerm<> term{.function = cubic_speed, .context = &cubic};
  EXPECT_DOUBLE_EQ(term(2.0, 3.0), 216.0);
  EXPECT_EQ(UserTerm<>{}(2.0, 3.0), 0.0);  // not set
}

TEST(TermList, FillsInOrderWithSignAndOffset) {
  const Cubic cubic{1.0};
  const TermList<Viscous, Friction<TanhSign>, UserTerm<>> list{
      Viscous{}, Friction<TanhSign>{{.sharpness_spm = 2.0}},
      UserTerm<>{.function = cubic_speed, .context = &cubic}};
  std::array<double, 5> flat{9.0, 9.0, 9.0, 9.0, 9.0};
  struct Out {
    std::array<double, 5>* values;
    double& operator[](int i) const { return (*values)[static_cast<std::size_t>(i)]; }
  } out{&flat};
  list.fill(1.0, 0.5, -1.0, out, 1);
  EXPECT_EQ(flat, (std::array{9.0, -0.5, -std::tanh(1.0), -0.125, 9.0}));
}

TEST(TermList, KnowsWhereItIsNotSmooth) {
  using Even = TermList<Viscous, CubicSpring, Friction<TanhSign>>;
  using DryAlone = TermList<Viscous, Friction<>>;
  using Linear = TermList<Viscous, ProgressiveFriction<>>;
  EXPECT_FALSE(Even::kKinkAtRest || Even::kKinkAtCentre);
  EXPECT_TRUE(DryAlone::kKinkAtRest && !DryAlone::kKinkAtCentre);
  EXPECT_TRUE(Linear::kKinkAtRest && Linear::kKinkAtCentre);
  EXPECT_TRUE((TermList<UserTerm<true>>::kKinkAtRest));
}

TEST(Models, CanBeCopiedByteByByte) {
  using List = TermList<Viscous, Spring, Friction<TanhSign>>;
  EXPECT_TRUE(std::is_trivially_copyable_v<List>);
  EXPECT_TRUE((std::is_trivially_copyable_v<ChainModel<List, List>>));
}

TEST(Models, OfAChainActAndReact) {
  using List = TermList<Viscous, Spring>;
  const ChainModel<List, List> chain;
  const auto g = chain.regressors({1.0, 3.0}, {0.5, 0.25});
  EXPECT_EQ(g.row(0), (Eigen::RowVector4d{0.5, 1.0, 0.25, -2.0}));
  EXPECT_EQ(g.row(1), (Eigen::RowVector4d{0.0, 0.0, -0.25, 2.0}));
}

TEST(Models, NameTheirGates) {
  using Even = TermList<Viscous, Spring>;
  using DryAlone = TermList<Viscous, Friction<>>;
  EXPECT_EQ(SingleModel<Even>::kGates, 0);
  EXPECT_EQ(SingleModel<DryAlone>::kGates, 1);
  EXPECT_EQ((ChainModel<Even, DryAlone>::kGates), 2);
  const auto chain = ChainModel<Even, DryAlone>{}.gates({1.0, 3.0});
  EXPECT_EQ(chain.deflection_m, (std::array{1.0, 2.0}));
  const auto grounded = GroundedFrictionModel<>{}.gates({1.0, 3.0});
  EXPECT_EQ(grounded.deflection_m, (std::array{1.0, 3.0}));
}

}  // namespace
}  // namespace dampline
