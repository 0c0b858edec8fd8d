// SPDX-License-Identifier: MIT
#include "app/verify/wavelet/models.hpp"
#include "app/verify/wavelet/published_case.hpp"
#include "app/verify/wavelet/selection.hpp"
#include "app/verify/wavelet/selection_checks.hpp"

namespace dampline::app {
namespace {

using Mask = TermMask<7>;

/// In the order of SevenTerms: c, k, k3, c3, k2, c2, e.
constexpr Mask kLinear{true, true};

template <class Sign>
CheckGroup group(const PublishedCase& published, const PublishedMse& mse, const Mask& true_terms) {
  using Over = SingleModel<SevenTerms<Sign>>;
  const auto input = measured<1>(published.simulate(), published.chain.mass_kg);
  return {.tables = {"17"},
          .title = published.title,
          .notes = {published.conditions,
                    "Seven terms: x', x, x^3, x^2 x', x^2, x'^2, sign x'; x^2 x' is Van der Pol's.",
                    kSpuriousNote},
          .checks = selection_checks(mse, select<D8, Over>(input, true_terms, kLinear),
                                     select<D16, Over>(input, true_terms, kLinear))};
}

}  // namespace

std::vector<CheckGroup> single_selection() {
  std::vector<CheckGroup> out{
      group<TanhSign>(duffing_case(true), {2.2e-10, 4.66, 1.3e-8}, {true, true, true}),
      group<TanhSign>(van_der_pol_case(true), {2.9e-7, 87.0, 0.61}, {true, true, false, true}),
      group<ExactSign>(coulomb_driven_case(), {1.2e-3, 2.75, 1.16},
                       {true, true, false, false, false, false, true}),
      group<TanhSign>(duffing_van_der_pol_case(), {5.6e-8, 77.0, 0.057}, {true, true, true, true})};
  out[2].notes.emplace_back(
      "The published excitation is not known; this one does not let it stick.");
  return out;
}

}  // namespace dampline::app
