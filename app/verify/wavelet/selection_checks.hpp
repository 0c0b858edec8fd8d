// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/verify/wavelet/figures.hpp"
#include "app/verify/wavelet/rows.hpp"
#include "published/wavelet/daubechies.hpp"
#include "published/wavelet/model_selection.hpp"

namespace dampline::app {

/// What tables 17 and 18 print of one system: MSE in per cent.
struct PublishedMse {
  double true_model{0.0};
  double linear{0.0};
  std::optional<double> over_specified{};
};

/// MSE in per cent (equation 35), in-sample and of blocks that were not fitted.
struct Mse {
  double in_sample{0.0};
  double held_out{0.0};
};

/// What the core's ModelSelection says of a run with one wavelet; MSE is that of mass 1.
struct SelectionFigures {
  Mse true_model, linear, over_specified;
  /// The least of the over-specified models that lack one of the true terms: no model without it
  /// can do better.
  Mse best_wrong;
  double least_true_t{0.0};
  double most_spurious_t{0.0};
  int wrong_choices{0};  ///< terms that choose() keeps although spurious, or drops although true
};

/// Why the t-ratios of D8 have no bound.
extern const char* const kSpuriousNote;

[[nodiscard]] std::vector<Check> selection_checks(const PublishedMse& published,
                                                  const SelectionFigures& d8,
                                                  const SelectionFigures& d16);

template <class Fit>
[[nodiscard]] Mse mse_of(const Fit& fit) {
  if (!fit.valid) return {NAN, NAN};
  return {fit.mse_percent[0], fit.held_out_mse_percent[0]};
}

/// Leaves one true term after the other out of the over-specified model.
template <class Selection>
[[nodiscard]] Mse best_wrong(const Selection& selection,
                             const TermMask<Selection::kUnknowns>& true_terms) {
  Mse out{INFINITY, INFINITY};
  for (std::size_t i = 0; i < true_terms.size(); ++i) {
    if (!true_terms[i]) continue;
    auto terms = Selection::everything();
    terms[i] = false;
    const Mse one = mse_of(selection.fit(terms));
    if (std::isnan(one.in_sample)) return one;
    out.in_sample = std::min(out.in_sample, one.in_sample);
    out.held_out = std::min(out.held_out, one.held_out);
  }
  return out;
}

/// `Over` is the over-specified model; the masks say which of its terms the system has, and which
/// the linear model has.
template <class Wavelet, class Over>
[[nodiscard]] SelectionFigures select(const Measured<Over::kDof>& measured,
                                      const TermMask<Over::kUnknowns>& true_terms,
                                      const TermMask<Over::kUnknowns>& linear_terms) {
  const auto selection = std::make_unique<ModelSelection<Over>>();
  for_each_row<MotionRows<Wavelet, Over>>(measured, Over{}, [&](const MotionRow<Over>& row) {
    selection->absorb(row, measured.config.mass_kg);
  });
  const auto over = selection->fit(ModelSelection<Over>::everything());
  const auto chosen = selection->choose();
  SelectionFigures out{.true_model = mse_of(selection->fit(true_terms)),
                       .linear = mse_of(selection->fit(linear_terms)),
                       .over_specified = mse_of(over),
                       .best_wrong = best_wrong(*selection, true_terms),
                       .least_true_t = INFINITY};
  for (std::size_t i = 0; i < true_terms.size(); ++i) {
    const double t = std::abs(over.t_ratio[static_cast<int>(i)]);
    double& worst = true_terms[i] ? out.least_true_t : out.most_spurious_t;
    worst = true_terms[i] ? std::min(worst, t) : std::max(worst, t);
    if (!chosen.valid || chosen.terms[i] != true_terms[i]) ++out.wrong_choices;
  }
  return out;
}

}  // namespace dampline::app
