// SPDX-License-Identifier: MIT
#include "published/wavelet/product_rows.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "tests/published/generate/product.hpp"
#include "tests/published/prescribed_motion.hpp"

namespace dampline {
namespace {

using Quadratic = SingleModel<TermList<Viscous, Spring, Power<1, 1>>>;

TEST(ProductTable, IsWhatTheGeneratorWrites) {
  std::ifstream file{DAMPLINE_SOURCE_DIR "/firmware_core/published/wavelet/product_table.hpp"};
  ASSERT_TRUE(file);
  std::ostringstream text;
  text << file.rdbuf();
  EXPECT_TRUE(text.str() == generate::product_header()) << "build the target connection_tables";
}

// phi's shifts add up to one, so that the sum over q is the connection coefficient of two
// functions.
TEST(ProductTable, SumsToTheConnectionCoefficients) {
  for (int p = -6; p <= 6; ++p) {
    double sum = 0.0;
    for (const double omega : kProductD8[static_cast<std::size_t>(p + 6)]) sum += omega;
    const double gamma = D8::kFirst[static_cast<std::size_t>(std::abs(p))];
    EXPECT_NEAR(sum, p < 0 ? -gamma : gamma, 1e-15) << p;
  }
}

// Integration by parts: (f g h)' integrates to zero, for f, g, h = phi(y), phi(y - q), phi(y - p).
TEST(ProductTable, ObeysTheProductRule) {
  const auto omega = [](int p, int q) {  // int phi(y) phi'(y - p) phi(y - q) dy
    const bool inside = std::abs(p) <= 6 && std::abs(q) <= 6;
    return inside ? kProductD8[static_cast<std::size_t>(p + 6)][static_cast<std::size_t>(q + 6)]
                  : 0.0;
  };
  for (int p = -6; p <= 6; ++p) {
    for (int q = -6; q <= 6; ++q) {
      const double sum = omega(p, q) + omega(q, p) + omega(-p, q - p);
      EXPECT_NEAR(sum, 0.0, 1e-15) << p << " " << q;
    }
  }
}

/// Largest error of the product over a motion, for one row form.
template <class Rows>
double worst_error(double step_s) {
  Rows rows = Rows::make({.step_s = step_s, .mass_kg = {1.0}}, Quadratic{}).value();
  const PrescribedMotion motion = two_tones();
  MotionRow<Quadratic> row;
  double worst = 0.0;
  for (int i = 0; i < 400; ++i) {
    if (!rows.push({.deflection_m = {motion.x(i * step_s)}, .force_n = {0.0}}, row)) continue;
    const double t = static_cast<double>(row.sample) * step_s;
    worst = std::max(worst, std::abs(row.regressors(0, 2) - motion.x(t) * motion.v(t)));
  }
  return worst;
}

TEST(ProductRows, AreOfThirdOrderAndTheSamplesProductOfEighth) {
  using Omega = ProductRows<Quadratic, 2>;
  using Samples = MotionRows<D8, Quadratic>;
  EXPECT_NEAR(std::log2(worst_error<Omega>(0.1) / worst_error<Omega>(0.05)), 3.0, 0.2);
  EXPECT_NEAR(std::log2(worst_error<Samples>(0.4) / worst_error<Samples>(0.2)), 8.0, 0.3);
  EXPECT_GT(worst_error<Omega>(0.1), 1e3 * worst_error<Samples>(0.1));
}

TEST(ProductRows, FindTheParametersOfTheQuadraticOscillator) {
  using Rows = ProductRows<Quadratic, 2>;
  Rows rows = Rows::make({.step_s = 0.01, .mass_kg = {1.0}}, Quadratic{}).value();
  const PrescribedMotion motion = two_tones();
  Information<4> information;
  MotionRow<Quadratic> row;
  for (int i = 0; i < 2000; ++i) {
    const double t = i * 0.01;
    const double x = motion.x(t);
    const double v = motion.v(t);
    const double f = motion.a(t) + 1.26 * v + 25.0 * x + 5.0 * x * v;
    if (rows.push({.deflection_m = {x}, .force_n = {f}}, row)) information.absorb(row.equation(0));
  }
  Information<4>::Vector theta;
  ASSERT_TRUE(information.solve(theta));
  EXPECT_NEAR(theta[0], 1.26, 1e-5);
  EXPECT_NEAR(theta[1], 25.0, 1e-5);
  EXPECT_NEAR(theta[2], 5.0, 1e-5);
  EXPECT_GT(std::abs(theta[2] - 5.0), 1e-9);  // it is not the other form
}

}  // namespace
}  // namespace dampline
