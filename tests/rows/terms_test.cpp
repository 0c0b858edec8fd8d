// SPDX-License-Identifier: MIT
#include "app/wavelet/terms.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "app/error.hpp"

namespace dampline::app::wavelet {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

RunTimeTerm one(const char* text) {
  const auto terms = parse_terms(text);
  EXPECT_EQ(terms.size(), 1U) << text;
  return terms.front();
}

TEST(Terms, ValuesAreThoseOfTheirFormulas) {
  const double x = -0.3;
  const double v = 0.7;
  EXPECT_DOUBLE_EQ(one("1")(x, v), 1.0);
  EXPECT_DOUBLE_EQ(one("x^3")(x, v), x * x * x);
  EXPECT_DOUBLE_EQ(one("x^2*v")(x, v), x * x * v);
  EXPECT_DOUBLE_EQ(one("sign(v)")(x, -v), -1.0);
  EXPECT_DOUBLE_EQ(one("tanh(2.5*v)")(x, v), std::tanh(2.5 * v));
  EXPECT_DOUBLE_EQ(one("erf(2*v)")(x, v), std::erf(2.0 * v));
  EXPECT_DOUBLE_EQ(one("atan(3*v)")(x, v), 2.0 / std::acos(-1.0) * std::atan(3.0 * v));
  EXPECT_DOUBLE_EQ(one("rational(4*v)")(x, v), 4.0 * v / (1.0 + 4.0 * v));
  EXPECT_DOUBLE_EQ(one("root(v;0.5)")(x, v), v / std::sqrt(v * v + 0.25));
  EXPECT_DOUBLE_EQ(one("|x|*sign(v)")(x, v), 0.3);
  EXPECT_DOUBLE_EQ(one("exp(-2*|v|)*sign(v)")(x, -v), -std::exp(-2.0 * v));
}

TEST(Terms, ReadBackFromTheirText) {
  for (const char* text :
       {"1", "a", "x", "v", "x^2", "x^3*v^2", "sign(v)", "tanh(1500*v)", "erf(20*v)", "atan(1*v)",
        "rational(7.5*v)", "root(v;0.001)", "|x|*sign(v)", "|x|*tanh(200*v)",
        "exp(-23.6*|v|)*sign(v)", "exp(-23.6*|v|)*tanh(1000*v)"})
    EXPECT_EQ(text_of(one(text)), text);
}

TEST(Terms, BlanksCaseAndMissingStarsDoNotMatter) {
  EXPECT_EQ(one(" X ^ 2 V"), one("x^2*v"));
  EXPECT_EQ(one("v*x*x"), one("x^2*v"));
  EXPECT_EQ(one("|x| Sign(v)"), one("|x|*sign(v)"));
  EXPECT_EQ(parse_terms("v, x, x^3, sign(v)").size(), 4U);
}

TEST(Terms, NamesAndUnitsAreThoseOfOtherRuns) {
  EXPECT_EQ(name_of(one("v")), "viscous");
  EXPECT_EQ(name_of(one("x")), "stiffness");
  EXPECT_EQ(name_of(one("sign(v)")), "coulomb");
  EXPECT_EQ(name_of(one("a")), "moving_mass");
  EXPECT_EQ(name_of(one("x^2*v")), "x^2*v");
  EXPECT_EQ(unit_of(one("v"), false), "N s/m");
  EXPECT_EQ(unit_of(one("x^3"), false), "N/m^3");
  EXPECT_EQ(unit_of(one("x^2*v"), false), "N s/m^3");
  EXPECT_EQ(unit_of(one("|x|*sign(v)"), false), "N/m");
  EXPECT_EQ(unit_of(one("tanh(5*v)"), false), "N");
  EXPECT_EQ(unit_of(one("a"), false), "kg");
  EXPECT_EQ(unit_of(one("x"), true), "1/s^2");
  EXPECT_EQ(unit_of(one("v"), true), "1/s");
  EXPECT_EQ(unit_of(one("sign(v)"), true), "m/s^2");
  EXPECT_EQ(unit_of(one("x^3"), true), "1/m^2 s^2");
}

TEST(Terms, WhatIsNotInTheVocabularyIsNamedAndTheVocabularyListed) {
  for (const char* text :
       {"", "y", "v,,x", "x^0", "x^10", "x^2*", "sin(v)", "tanh(v)", "tanh(-3*v)", "tanh(nan*v)",
        "sign(x)", "|v|*sign(v)", "exp(-5*|v|)", "2*x", "v,"})
    EXPECT_THAT([text] { static_cast<void>(parse_terms(text)); },
                ThrowsMessage<UsageError>(HasSubstr("exp(-A*|v|)*sign(v)")))
        << text;
  EXPECT_THAT([] { static_cast<void>(parse_terms("v, x, x*v, cosh(x)")); },
              ThrowsMessage<UsageError>(HasSubstr("found 'cosh(x)'")));
  EXPECT_THAT([] { static_cast<void>(parse_terms("x*v, v x")); },
              ThrowsMessage<UsageError>(HasSubstr("'x*v' twice")));
}

TEST(Terms, KinksAreWhereTheLawJumps) {
  EXPECT_TRUE(one("sign(v)").kink_at_rest());
  EXPECT_FALSE(one("tanh(1000*v)").kink_at_rest());
  EXPECT_TRUE(one("|x|*tanh(9*v)").kink_at_centre());
  EXPECT_FALSE(one("x^2").kink_at_centre());
}

// d/dx and d/dv of x^2 v are 2 x v and x^2: their functions without the factors.
TEST(Terms, SensitivitiesAreTheDerivativesFunctions) {
  const Sensitivities of = sensitivities_of(one("x^2*v"));
  ASSERT_EQ(of.count, 2U);
  EXPECT_EQ(of.terms[0], one("x*v"));
  EXPECT_EQ(of.terms[1], one("x^2"));
  EXPECT_EQ(sensitivities_of(one("x")).count, 0U) << "a constant";
}

}  // namespace
}  // namespace dampline::app::wavelet
