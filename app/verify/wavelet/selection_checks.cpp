// SPDX-License-Identifier: MIT
#include "app/verify/wavelet/selection_checks.hpp"

namespace dampline::app {
namespace {

/// A true term must have at least this |t|, a spurious one at most that.
constexpr double kLeastTrueT = 10.0;
constexpr double kMostSpuriousT = 4.0;
/// A model without a term of the system has at least so many times the true one's MSE.
constexpr double kLeastRatio = 100.0;

}  // namespace

const char* const kSpuriousNote =
    "With D8 the residual is its own discretisation error, as smooth as the motion and no noise: "
    "|t| of spurious terms is held to 4 with D16, whose residual is rounding.";

std::vector<Check> selection_checks(const PublishedMse& published, const SelectionFigures& d8,
                                    const SelectionFigures& d16) {
  const double least_wrong = kLeastRatio * d8.true_model.in_sample;
  const double least_wrong_held_out = kLeastRatio * d8.true_model.held_out;
  return {{"MSE, true model, D8",
           "%",
           published.true_model,
           d8.true_model.in_sample,
           published.true_model,
           {}},
          {"MSE, linear model, D8", "%", published.linear, d8.linear.in_sample, {}, least_wrong},
          {"MSE, best model without one of the true terms, D8",
           "%",
           {},
           d8.best_wrong.in_sample,
           {},
           least_wrong},
          {"MSE, over-specified model, D8",
           "%",
           published.over_specified,
           d8.over_specified.in_sample,
           {},
           {}},
          {"held-out MSE, true model, D8", "%", {}, d8.true_model.held_out, {}, {}},
          {"held-out MSE, linear model, D8", "%", {}, d8.linear.held_out, {}, least_wrong_held_out},
          {"held-out MSE, best model without one of the true terms, D8",
           "%",
           {},
           d8.best_wrong.held_out,
           {},
           least_wrong_held_out},
          {"held-out MSE, over-specified model, D8", "%", {}, d8.over_specified.held_out, {}, {}},
          {"MSE, true model, D16",
           "%",
           published.true_model,
           d16.true_model.in_sample,
           published.true_model,
           {}},
          {"least |t| of a true term, D16", "1", {}, d16.least_true_t, {}, kLeastTrueT},
          {"largest |t| of a spurious term, D16", "1", {}, d16.most_spurious_t, kMostSpuriousT, {}},
          {"largest |t| of a spurious term, D8", "1", {}, d8.most_spurious_t, {}, {}},
          {"terms chosen wrongly or missed, D8", "1", {}, double(d8.wrong_choices), 0.0, {}},
          {"terms chosen wrongly or missed, D16", "1", {}, double(d16.wrong_choices), 0.0, {}}};
}

}  // namespace dampline::app
