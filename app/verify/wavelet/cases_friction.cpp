// SPDX-License-Identifier: MIT
#include <numbers>
#include <string>

#include "app/verify/wavelet/published_case.hpp"

namespace dampline::app {
namespace {

using sim::reference::Element;
using sim::reference::Link;
using sim::reference::Real;
using sim::reference::Signum;
using sim::reference::single;

struct LinearCoulomb {
  double ratio, slope_npm;
  double c, k, e, fk;
  std::vector<double> spread;  ///< none: only a range was available
};

const std::vector<LinearCoulomb>& linear_coulomb_published() {
  static const std::vector<LinearCoulomb> all{
      {1.2, 5, 0.525, 25.015, 0.189, 5.101, {0.22, 6.6e-3, 0.28, 0.11}},
      {1.2, 10, 0.581, 25.119, 0.172, 10.337, {0.48, 1.3e-2, 0.60, 0.13}},
      {0.6, 5, 0.438, 25.033, 0.218, 4.778, {}},
      {0.6, 10, 0.447, 25.03, 0.218, 9.787, {}}};
  return all;
}

std::vector<PublishedParameter> linear_coulomb_parameters(double ratio, double slope_npm) {
  std::vector<PublishedParameter> out{
      {"c", "N s/m", 0.5}, {"k", "N/m", 25}, {"e", "N", 0.2}, {"fk", "N/m", slope_npm}};
  for (const LinearCoulomb& one : linear_coulomb_published()) {
    if (one.ratio != ratio || one.slope_npm != slope_npm) continue;
    out[0].value = one.c;
    out[1].value = one.k;
    out[2].value = one.e;
    out[3].value = one.fk;
    for (std::size_t i = 0; i < one.spread.size(); ++i) out[i].spread = one.spread[i];
  }
  return out;
}

}  // namespace

PublishedCase coulomb_free_case() {
  return {
      .tables = {"12"},
      .title = "Coulomb friction, free",
      .conditions = "m = 1 kg, x'' + c x' + k x + e sign x' = 0, from x = 1 m at rest",
      .notes = {},
      .chain = single({.k = 10, .c = 0.2L, .e = 0.2L}, {}),
      .start = {{1}, {0}},
      .resolution = {.step_s = 0.023, .samples = 523, .substeps = 16},
      .parameters = {{"c", "N s/m", 0.2, 0.193}, {"k", "N/m", 10, 10.00}, {"e", "N", 0.2, 0.206}}};
}

PublishedCase coulomb_forced_case(Signum signum) {
  PublishedCase out{
      .tables = {"13"},
      .title = "Coulomb friction, forced",
      .conditions = "m = 1 kg, x'' + c x' + k x + e sign x' = sin(0.5 t) N, from rest",
      .notes = {"Not published, assumed: time step 0.01 s, five cycles."},
      .chain = single({.k = 25, .c = 0.5L, .e = 0.2L, .signum = signum}, {{1, 0.5L, 0}}),
      .start = {},
      .resolution = {.step_s = 0.01, .samples = 6284, .substeps = 8},
      .parameters = {{"c", "N s/m", 0.5, 0.507, 0.26},
                     {"k", "N/m", 25, 25.0, 9.5e-5},
                     {"e", "N", 0.2, 0.2, 8.2e-4}}};
  if (signum != Signum::kExact) {
    out.resolution = {
        .step_s = 0.01, .samples = 3770, .substeps = 16, .slow_substeps = 40, .slow_mps = 0.02L};
    out.notes = {"Not published, assumed: time step 0.01 s, three cycles, windows of 314 rows."};
  }
  return out;
}

PublishedCase coulomb_driven_case() {
  PublishedCase out = coulomb_forced_case(Signum::kExact);
  out.tables = {"17"};
  out.conditions = "m = 1 kg, x'' + c x' + k x + e sign x' = sin(4 t) N, from rest";
  out.chain.inputs = {{{1, 4, 0}}};
  return out;
}

PublishedCase coulomb_chain_case() {
  const Element grounded{.k = 10000, .c = 10, .e = 1};
  return {
      .tables = {"14"},
      .title = "two masses, Coulomb friction",
      .conditions =
          "m = 1 kg each, M x'' + C x' + K x + e sign x' = 7.5 [sin 105 t, sin 95 t] N; the "
          "publication's centimetre stands for the metre",
      .notes =
          {"Misprints 1995.8 and -1012.0 read as 19958 and -10012, as the printed errors demand.",
           "Not published, assumed: time step 0.001 s, 4 s."},
      .chain = {.mass_kg = {1, 1},
                .links = {{Link::kGround, 0, grounded},
                          {0, 1, {.k = 10000}},
                          {Link::kGround, 1, grounded}},
                .inputs = {{{7.5L, 105, 0}}, {{7.5L, 95, 0}}}},
      .start = {},
      .resolution = {.step_s = 0.001, .samples = 4000, .substeps = 4},
      .parameters = {{"c11", "N s/m", 10, 10.14, 8.3e-2},
                     {"k11", "N/m", 20000, 19958.0, 1.3e-2},
                     {"k12", "N/m", -10000, -10012.0},
                     {"c22", "N s/m", 10, 10.09},
                     {"k22", "N/m", 20000, 20018.7},
                     {"e1", "N", 1, 0.97, 8.7e-2},
                     {"e2", "N", 1, 0.964}}};
}

PublishedCase linear_coulomb_case(double ratio, double slope_npm) {
  PublishedCase out{
      .tables = {"15"},
      .title = "linear/Coulomb friction",
      .conditions = "m = 1 kg, x'' + c x' + k x + (e + fk |x|) sign x' = sin(b w0 t) N, from rest",
      .notes = {"The publication's f is fk / k.",
                "Not published, assumed: time step 0.005 s, 60 s, windows of two cycles: in one "
                "quadrant of (x, x') x and |x| sign x' are the same but for a sign, and windows of "
                "32 rows within it are left out as singular."},
      .chain = single({.k = 25, .c = 0.5L, .e = 0.2L, .fk = static_cast<Real>(slope_npm)},
                      {{1, static_cast<Real>(ratio) * 5, 0}}),
      .start = {},
      .resolution = {.step_s = 0.005, .samples = 12000, .substeps = 4},
      .parameters = linear_coulomb_parameters(ratio, slope_npm)};
  if (!out.parameters[0].spread)
    out.notes.emplace_back("Published coefficients of variation: 0.15 to 0.42.");
  return out;
}

PublishedCase teflon_case() {
  return {
      .tables = {"16"},
      .title = "Teflon on steel",
      .conditions =
          "m = 1 kg, x'' + c x' + k x + (e + d exp(-a |x'|)) sign x' = sin(0.5 pi t) N, from rest",
      .notes =
          {"m = 1 kg, as k and the natural frequency pi rad/s demand; the printed 0.77 "
           "contradicts them. a = 23.6 s/m (0.0236 s/mm), d < 0.",
           "c is 0: errors and deviations of c are absolute.",
           "Not published, assumed: time step 0.005 s, 40 s, sign v as tanh(1500 v), windows of "
           "400 rows."},
      .chain =
          single({.k = 9.87L, .e = 1.17L, .t = -0.909L, .a_spm = 23.6L, .signum = Signum::kTanh},
                 {{1, std::numbers::pi_v<Real> / 2, 0}}),
      .start = {},
      .resolution =
          {.step_s = 0.005, .samples = 8000, .substeps = 6, .slow_substeps = 24, .slow_mps = 0.02L},
      .parameters = {{"c", "N s/m", 0, 2.5e-3, 1.6e-2},
                     {"k", "N/m", 9.87, 9.87, 3.8e-4},
                     {"e", "N", 1.17, 1.17, 1.2e-3},
                     {"d", "N", -0.909, -0.909, 2.1e-3}}};
}

}  // namespace dampline::app
