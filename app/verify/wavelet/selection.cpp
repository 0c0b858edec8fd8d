// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/verify/wavelet/cases.hpp"
#include "app/verify/wavelet/figures.hpp"
#include "app/verify/wavelet/properties.hpp"
#include "app/verify/wavelet/response.hpp"
#include "app/verify/wavelet/rows.hpp"
#include "published/wavelet/daubechies.hpp"
#include "published/wavelet/model_selection.hpp"

namespace dampline::app {
namespace {

/// MSE in per cent (equation 35), in-sample and of blocks that were not fitted.
struct Mse {
  double in_sample{0.0};
  double held_out{0.0};
};

/// What the core's ModelSelection says of a run with one wavelet, MSE of one of the masses.
struct SelectionFigures {
  Mse true_model, linear, over_specified;
  /// The least of the over-specified models that lack one of the true terms: no model without it
  /// can do better.
  Mse best_wrong;
  double least_true_t{0.0};
  double most_spurious_t{0.0};
  int wrong_choices{0};  ///< terms that choose() keeps although spurious, or drops although true
};

template <class Fit>
Mse mse_of(const Fit& fit, std::size_t mass) {
  if (!fit.valid) return {NAN, NAN};
  return {fit.mse_percent[mass], fit.held_out_mse_percent[mass]};
}

/// Leaves one true term after the other out of the over-specified model.
template <class Selection>
Mse best_wrong(const Selection& selection, const TermMask<Selection::kUnknowns>& true_terms,
               std::size_t mass) {
  Mse out{INFINITY, INFINITY};
  for (std::size_t i = 0; i < true_terms.size(); ++i) {
    if (!true_terms[i]) continue;
    auto terms = Selection::everything();
    terms[i] = false;
    const Mse one = mse_of(selection.fit(terms), mass);
    if (std::isnan(one.in_sample)) return one;
    out.in_sample = std::min(out.in_sample, one.in_sample);
    out.held_out = std::min(out.held_out, one.held_out);
  }
  return out;
}

/// `Over` is the over-specified model; the masks say which of its terms the system has, and which
/// the linear model has.
template <class Wavelet, class Over>
SelectionFigures select(const Measured<Over::kDof>& measured,
                        const TermMask<Over::kUnknowns>& true_terms,
                        const TermMask<Over::kUnknowns>& linear_terms, std::size_t mass) {
  const auto selection = std::make_unique<ModelSelection<Over>>();
  for_each_row<MotionRows<Wavelet, Over>>(measured, Over{}, [&](const MotionRow<Over>& row) {
    selection->absorb(row, measured.config.mass_kg);
  });
  const auto over = selection->fit(ModelSelection<Over>::everything());
  const auto chosen = selection->choose();
  SelectionFigures out{.true_model = mse_of(selection->fit(true_terms), mass),
                       .linear = mse_of(selection->fit(linear_terms), mass),
                       .over_specified = mse_of(over, mass),
                       .best_wrong = best_wrong(*selection, true_terms, mass),
                       .least_true_t = INFINITY};
  for (std::size_t i = 0; i < true_terms.size(); ++i) {
    const double t = std::abs(over.t_ratio[static_cast<int>(i)]);
    double& worst = true_terms[i] ? out.least_true_t : out.most_spurious_t;
    worst = true_terms[i] ? std::min(worst, t) : std::max(worst, t);
    if (!chosen.valid || chosen.terms[i] != true_terms[i]) ++out.wrong_choices;
  }
  return out;
}

/// A true term must have at least this |t|, a spurious one at most that.
constexpr double kLeastTrueT = 10.0;
constexpr double kMostSpuriousT = 4.0;
/// A model without a term of the system has at least so many times the true one's MSE.
constexpr double kLeastRatio = 100.0;

/// Why the t-ratios of D8 have no bound.
constexpr const char* kSpuriousNote =
    "With D8 the residual is its own discretisation error, as smooth as the motion and no noise: "
    "|t| of spurious terms is held to 4 with D16, whose residual is rounding.";

using Row = std::pair<const PrintedTable*, std::string>;

Row row_of(const char* table, const std::string& name) {
  return {&printed_table(ghanem_romeo(), table), name};
}

std::optional<Printed> figure(const Row& row, const std::string& column) {
  if (row.first->text(row.second, column) == "-") return {};
  return row.first->at(row.second, column);
}

/// `published`: the MSE of the true model as printed.
std::vector<Check> selection_checks(const Printed& published, const SelectionFigures& d8,
                                    const SelectionFigures& d16) {
  const double least_wrong = kLeastRatio * d8.true_model.in_sample;
  const double least_wrong_held_out = kLeastRatio * d8.true_model.held_out;
  const auto of_true = [&](const char* what, double found) {
    return Check{what, "%", published, found, published.value, {}};
  };
  const auto of_wrong = [](const char* what, double found, double least) {
    return Check{what, "%", {}, found, {}, least};
  };
  return {of_true("MSE, true model, D8", d8.true_model.in_sample),
          of_wrong("MSE, linear model, D8", d8.linear.in_sample, least_wrong),
          of_wrong("MSE, best model without one of the true terms, D8", d8.best_wrong.in_sample,
                   least_wrong),
          {"MSE, over-specified model, D8", "%", {}, d8.over_specified.in_sample, {}, {}},
          {"held-out MSE, true model, D8", "%", {}, d8.true_model.held_out, {}, {}},
          of_wrong("held-out MSE, linear model, D8", d8.linear.held_out, least_wrong_held_out),
          of_wrong("held-out MSE, best model without one of the true terms, D8",
                   d8.best_wrong.held_out, least_wrong_held_out),
          {"held-out MSE, over-specified model, D8", "%", {}, d8.over_specified.held_out, {}, {}},
          of_true("MSE, true model, D16", d16.true_model.in_sample),
          {"least |t| of a true term, D16", "1", {}, d16.least_true_t, {}, kLeastTrueT},
          {"largest |t| of a spurious term, D16", "1", {}, d16.most_spurious_t, kMostSpuriousT, {}},
          {"largest |t| of a spurious term, D8", "1", {}, d8.most_spurious_t, {}, {}},
          {"terms chosen wrongly or missed, D8", "1", {}, double(d8.wrong_choices), 0.0, {}},
          {"terms chosen wrongly or missed, D16", "1", {}, double(d16.wrong_choices), 0.0, {}}};
}

using SingleMask = TermMask<7>;

/// In the order of SevenTerms: c, k, k3, c3, k2, c2, e.
constexpr SingleMask kSingleLinear{true, true};

template <class Sign>
CheckGroup single_group(const PublishedCase& published, const char* row,
                        const SingleMask& true_terms) {
  using Over = SingleModel<SevenTerms<Sign>>;
  const auto input = measured<1>(published.simulate(), published.chain.mass_kg);
  return {.tables = {"17"},
          .title = published.title + ", residual of the fit",
          .notes = {published.conditions,
                    "Seven terms: x', x, x^3, x^2 x', x^2, x'^2, sign x'; x^2 x' is Van der Pol's.",
                    kSpuriousNote},
          .checks = selection_checks(*figure(row_of("17", row), "True"),
                                     select<D8, Over>(input, true_terms, kSingleLinear, 0),
                                     select<D16, Over>(input, true_terms, kSingleLinear, 0))};
}

using ChainMask = TermMask<10>;
using ChainOver = ChainModel<FiveTerms, FiveTerms>;

/// In the order of FiveTerms: c, k, k3, c3, e of each element.
constexpr ChainMask kChainLinear{true, true, false, false, false, true, true, false, false, false};

void add_chain_groups(const PublishedCase& published, const char* row, const ChainMask& true_terms,
                      std::vector<CheckGroup>& out) {
  const auto input = measured<2>(published.simulate(), published.chain.mass_kg);
  for (std::size_t mass = 0; mass < 2; ++mass) {
    out.push_back(
        {.tables = {"18"},
         .title = fmt::format("{}, mass {}, residual of the fit", published.title, mass + 1),
         .notes = {published.conditions, "Ten terms: z', z, z^3, z^2 z', sign z' of each element.",
                   "Not published, assumed: the excitation of tables 8 and 9, 4 s.", kSpuriousNote},
         .checks =
             selection_checks(*figure(row_of("18", row), fmt::format("True {}", mass + 1)),
                              select<D8, ChainOver>(input, true_terms, kChainLinear, mass),
                              select<D16, ChainOver>(input, true_terms, kChainLinear, mass))});
  }
}

/// One of a row's models, as equation 35 has it.
struct ResponseModel {
  std::string column;
  std::string name;
  std::vector<std::string> terms;
};

constexpr const char* kResponseNote =
    "Equation 35 between accelerations: 512 samples (level j = 9), D8 in windows of 32 equations, "
    "the mean over the windows simulated under the same input. 'inf': the estimated model's "
    "response grows without bound.";

/// The linear models whose systems and inputs are published come this near: found 0.1 to 15 %.
constexpr double kNear = 0.2;

CheckGroup response_group(const PublishedCase& published, const Row& row,
                          const std::vector<ResponseModel>& models, bool near) {
  CheckGroup out{.tables = {row.first->name},
                 .title = published.title + ", simulated response",
                 .notes = {published.conditions, kResponseNote},
                 .checks = {}};
  for (const ResponseModel& model : models) {
    const std::vector<double> found = response_mse_percent(published, element_terms(model.terms));
    for (std::size_t d = 0; d < found.size(); ++d) {
      const std::string mass = found.size() == 1 ? "" : fmt::format(" {}", d + 1);
      Check check{
          .what = "MSE of the response, " + model.name + (mass.empty() ? "" : ", mass" + mass),
          .unit = "%",
          .published = figure(row, model.column + mass),
          .found = found[d]};
      if (near && model.column == "Linear") {
        check.at_least = (1.0 - kNear) * check.published->value;
        check.at_most = (1.0 + kNear) * check.published->value;
      }
      out.checks.push_back(check);
    }
  }
  return out;
}

std::vector<ResponseModel> single_models(const std::vector<std::string>& true_terms) {
  return {{"True", "true model", true_terms},
          {"Linear", "linear model", {"c", "k"}},
          {"7 Terms",
           "7 terms, c(3) with x^2 x' (equation 25)",
           {"k", "c", "k2", "c2", "k3", "x^2 x'", "e"}},
          {"7 Terms",
           "7 terms, c(3) with x'^3 (equation 3)",
           {"k", "c", "k2", "c2", "k3", "x'^3", "e"}}};
}

std::vector<ResponseModel> chain_models(const std::vector<std::string>& true_terms) {
  return {{"True", "true model", true_terms},
          {"Linear", "linear model", {"c", "k"}},
          {"10 Terms*", "10 terms with Coulomb friction", {"c", "k", "k3", "x^2 x'", "e"}},
          {"10 Terms**", "10 terms with square springs", {"c", "k", "k2", "k3", "x^2 x'"}}};
}

}  // namespace

std::vector<CheckGroup> single_selection() {
  const auto both = duffing_van_der_pol_case(InputOf::kVanDerPol, Drive::kHalfSlope);
  std::vector<CheckGroup> out{
      single_group<TanhSign>(duffing_case(Drive::kHalfSlope), "(1) Duffing", {true, true, true}),
      single_group<TanhSign>(van_der_pol_case(Drive::kHalfSlope), "(2) Van der Pol",
                             {true, true, false, true}),
      single_group<ExactSign>(coulomb_driven_case(), "Coulomb",
                              {true, true, false, false, false, false, true}),
      single_group<TanhSign>(both, "(1)+(2)", {true, true, true, true})};
  out[2].notes.emplace_back(
      "The published excitation is not known; this one does not let it stick.");
  return out;
}

std::vector<CheckGroup> single_responses() {
  const auto group = [](const PublishedCase& published, const char* row, bool near,
                        const std::vector<std::string>& true_terms) {
    return response_group(published, row_of("17", row), single_models(true_terms), near);
  };
  std::vector<CheckGroup> out{
      group(duffing_case(Drive::kEquations), "(1) Duffing", true, {"c", "k", "k3"}),
      group(van_der_pol_case(Drive::kEquations), "(2) Van der Pol", true, {"c", "k", "x^2 x'"}),
      group(coulomb_driven_case(), "Coulomb", false, {"c", "k", "e"}),
      group(coulomb_free_case(), "Coulomb", false, {"c", "k", "e"}),
      group(coulomb_forced_case(sim::reference::Signum::kExact), "Coulomb", false, {"c", "k", "e"}),
      group(duffing_van_der_pol_case(InputOf::kDuffing, Drive::kEquations), "(1)+(2)", true,
            {"c", "k", "k3", "x^2 x'"}),
      group(duffing_van_der_pol_case(InputOf::kVanDerPol, Drive::kEquations), "(1)+(2)", false,
            {"c", "k", "k3", "x^2 x'"})};
  out[1].notes.emplace_back(
      "The published 0.610 % needs x^2 x' among the seven terms: with the x'^3 of equation 3 the "
      "model cannot follow Van der Pol's damping.");
  for (const std::size_t tried : {2U, 3U, 4U}) {
    out[tried].notes.emplace_back(
        "Not reproduced: which system and input the Coulomb row has is not published. Tried: sin(4 "
        "t) from rest, and the systems of tables 12 (free; the nearest) and 13 (forced, with two "
        "stops a cycle, through which no linear model follows). In the first two the seven terms "
        "find the true model, so that a published 1.1553 % is not reached by them.");
  }
  return out;
}

std::vector<CheckGroup> chain_selection() {
  constexpr ChainMask kDuffing{true, true, true, false, false, true, true, true, false, false};
  constexpr ChainMask kVanDerPol{true, true, false, true, false, true, true, false, true, false};
  constexpr ChainMask kBoth{true, true, true, true, false, true, true, true, true, false};
  std::vector<CheckGroup> out;
  add_chain_groups(duffing_chain_case(true), "(1) Duffing", kDuffing, out);
  add_chain_groups(van_der_pol_chain_case(true), "(2) Van der Pol", kVanDerPol, out);
  add_chain_groups(duffing_van_der_pol_chain_case(), "(1)+(2)", kBoth, out);
  return out;
}

std::vector<CheckGroup> chain_responses() {
  const auto group = [](const PublishedCase& published, const char* row, bool near,
                        const std::vector<std::string>& true_terms) {
    return response_group(published, row_of("18", row), chain_models(true_terms), near);
  };
  std::vector<CheckGroup> out{
      group(duffing_chain_case(true), "(1) Duffing", true, {"c", "k", "k3"}),
      group(van_der_pol_chain_case(true), "(2) Van der Pol", true, {"c", "k", "x^2 x'"}),
      group(coulomb_elements_case(), "Coulomb", false, {"c", "k", "e"}),
      group(duffing_van_der_pol_chain_case(), "(1)+(2)", false, {"c", "k", "k3", "x^2 x'"})};
  out[2].notes.emplace_back(
      "Neither the published system nor its input is known: 1000 N of friction in both elements of "
      "table 7, sign z' as tanh(1500 z').");
  out[3].notes.emplace_back(
      "Not reproduced: with the terms of both systems in both elements the linear model's error is "
      "that of Van der Pol's. One system in each element gives 3.7 and 0.6 %, or 39 and 9 %.");
  return out;
}

}  // namespace dampline::app
