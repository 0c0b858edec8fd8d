// SPDX-License-Identifier: MIT
#include <numbers>

#include "app/verify/wavelet/published_case.hpp"

namespace dampline::app {
namespace {

using sim::reference::Input;
using sim::reference::Real;
using sim::reference::single;
using sim::reference::Start;

constexpr Real kPi = std::numbers::pi_v<Real>;

/// From 0.5 to 1.5 rad/s within so many periods of 2 pi s.
Input sweep(Real amplitude_n, int periods) {
  return {{amplitude_n, 0.5L, 1 / (2 * kPi * static_cast<Real>(periods))}};
}

const char* const kSweepNote =
    "The phase is (0.5 + t / (2 Tf)) t, the sweep of table 2; equation 23 describes another.";

Start released() { return {{1}, {0}}; }

}  // namespace

PublishedCase product_case() {
  return {.tables = {"1"},
          .title = "product x x'",
          .conditions = "m = 1 kg, x'' + c x' + k x + d x x' = sin(4 pi t) N, from rest",
          .notes = {"Published coefficients of variation: those of equation 13.",
                    "Not published, assumed: time step 0.01 s, 20 s."},
          .chain = single({.k = 25, .c = 1.26L, .d = 5}, {{1, 4 * kPi, 0}}),
          .start = {},
          .resolution = {.step_s = 0.01, .samples = 2000, .substeps = 4},
          .parameters = {{"c", "N s/m", 1.26, {}, 1.2e-3},
                         {"k", "N/m", 25.0, {}, 1.6e-3},
                         {"d", "N s/m^2", 5.0, {}, 3.0e-3}}};
}

PublishedCase duffing_case(bool forced) {
  PublishedCase out{
      .tables = {forced ? "3" : "5"},
      .title = forced ? "Duffing, forced" : "Duffing, free",
      .conditions = forced
                        ? "m = 1 kg, x'' + c x' + k x + k3 x^3 = 4 sin(phase) N, 0.5 to 1.5 rad/s "
                          "in 49 periods of 2 pi s, from rest"
                        : "m = 1 kg, x'' + c x' + k x + k3 x^3 = 0, from x = 1 m at rest",
      .notes = {},
      .chain = single({.k = 1, .k3 = 0.003L, .c = 0.04L}, forced ? sweep(4, 49) : Input{}),
      .start = forced ? Start{} : released(),
      .resolution = {.step_s = 0.05, .samples = forced ? 6158U : 1257U, .substeps = 8},
      .parameters = {{"c", "N s/m", 0.04, {}, forced ? 1.1e-7 : 2.2e-6},
                     {"k", "N/m", 1.0, {}, forced ? 2.3e-6 : 1.0e-7},
                     {"k3", "N/m^3", 0.003, {}, forced ? 2.4e-6 : 5.9e-5}}};
  if (forced) {
    out.notes = {kSweepNote, "Time step as in the text; the ratios dt/T of table 2 contradict it."};
  } else {
    out.notes = {"Not published, assumed: 62.8 s."};
  }
  return out;
}

PublishedCase van_der_pol_case(bool forced) {
  PublishedCase out{
      .tables = forced ? std::vector<std::string>{"3", "4"} : std::vector<std::string>{"5", "6"},
      .title = forced ? "Van der Pol, forced" : "Van der Pol, free",
      .conditions = forced ? "m = 1 kg, x'' + c x' + c3 x^2 x' + k x = 10 sin(phase) N, 0.5 to 1.5 "
                             "rad/s in 10 periods of 2 pi s, from rest"
                           : "m = 1 kg, x'' + c x' + c3 x^2 x' + k x = 0, from x = 1 m at rest",
      .notes = {},
      .chain = single({.k = 1, .c = -0.2L, .w = 0.2L}, forced ? sweep(10, 10) : Input{}),
      .start = forced ? Start{} : released(),
      .resolution = {.step_s = 0.02, .samples = 3142, .substeps = 8},
      .parameters = {{"c", "N s/m", -0.2, {}, forced ? 3.8e-5 : 1.4e-5},
                     {"k", "N/m", 1.0, {}, forced ? 2.2e-6 : 3.5e-6},
                     {"c3", "N s/m^3", 0.2, {}, forced ? 1.5e-6 : 6.7e-6}}};
  if (forced) {
    out.notes = {kSweepNote,
                 "Coefficients of variation of c and k exchanged: the one with the sign of the "
                 "negative c stands in the column of k.",
                 "The first table and the second hold the same figures."};
  } else {
    out.notes = {"Coefficients of variation of c and k exchanged, as in the forced case.",
                 "Not published, assumed: 62.8 s."};
  }
  return out;
}

PublishedCase duffing_van_der_pol_case() {
  return {.tables = {"17"},
          .title = "Duffing and Van der Pol, forced",
          .conditions = "m = 1 kg, x'' + c x' + c3 x^2 x' + k x + k3 x^3 = f, f of Van der Pol",
          .notes = {},
          .chain = single({.k = 1, .k3 = 0.003L, .c = -0.2L, .w = 0.2L}, sweep(10, 10)),
          .start = {},
          .resolution = {.step_s = 0.02, .samples = 3142, .substeps = 8},
          .parameters = {}};
}

}  // namespace dampline::app
