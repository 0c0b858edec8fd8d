// SPDX-License-Identifier: MIT
#include "app/verify/wavelet/cases.hpp"

#include <numbers>
#include <string>

namespace dampline::app {
namespace {

using sim::reference::Element;
using sim::reference::Input;
using sim::reference::Link;
using sim::reference::Real;
using sim::reference::Signum;
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

constexpr Element kFirst{.k = 7241, .c = 21};
constexpr Element kSecond{.k = 14900, .c = 60};

/// The first element to the ground, the second between the masses; free: from 0.1 m each at rest.
PublishedCase chain_of(Element first, Element second, bool forced) {
  const Input input{{10000, 25, 0}, {10000, 35, 0}};
  return {.tables = {},
          .title = "",
          .conditions = forced ? "m = 12 kg each, 10000 (sin 25 t + sin 35 t) N on each, from rest"
                               : "m = 12 kg each, free, from 0.1 m each at rest",
          .notes = {},
          .chain = {.mass_kg = {12, 12},
                    .links = {{Link::kGround, 0, first}, {0, 1, second}},
                    .inputs = forced ? std::vector<Input>{input, input} : std::vector<Input>{}},
          .start = forced ? Start{} : Start{{0.1L, 0.1L}, {}},
          .resolution = {.step_s = 0.001, .samples = 4000, .substeps = 2},
          .parameters = {}};
}

PublishedCase with_duffing(bool forced) {
  Element first = kFirst;
  Element second = kSecond;
  first.k3 = 72.14L;
  second.k3 = -223;
  return chain_of(first, second, forced);
}

PublishedCase with_van_der_pol(bool forced) {
  Element first = kFirst;
  Element second = kSecond;
  first.w = 50;
  second.w = 150;
  return chain_of(first, second, forced);
}

const char* const kLengthNote = "Not published, assumed: 4 s.";

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

PublishedCase duffing_chain_case(bool forced) {
  PublishedCase out = with_duffing(forced);
  out.title = forced ? "two masses, Duffing, forced" : "two masses, Duffing, free";
  if (forced) {
    out.tables = {"8"};
    out.notes = {kLengthNote};
    out.parameters = {{"c1", "N s/m", 21, {}, 2.3e-5},      {"k1", "N/m", 7241, {}, 2.3e-6},
                      {"k3_1", "N/m^3", 72.14, {}, 8.2e-6}, {"c2", "N s/m", 60, {}, 2.2e-5},
                      {"k2", "N/m", 14900, {}, 3.1e-6},     {"k3_2", "N/m^3", -223, {}, 6.9e-5}};
    return out;
  }
  out.tables = {"10"};
  out.notes = {"Not published, assumed: 3 s."};
  out.resolution = {.step_s = 0.003, .samples = 1000, .substeps = 8};
  out.parameters = {{"c1", "N s/m", 21, {}, 2.1e-6},
                    {"k1", "N/m", 7241, {}, 1.6e-7},
                    {"k3_1", "N/m^3", 72.14, 72.12, 4.1e-3, true},
                    {"c2", "N s/m", 60, {}, 1.1e-6},
                    {"k2", "N/m", 14900, {}, 1.5e-7},
                    {"k3_2", "N/m^3", -223, -222.3, 3.9e-2, true}};
  return out;
}

PublishedCase van_der_pol_chain_case(bool forced) {
  PublishedCase out = with_van_der_pol(forced);
  out.title = forced ? "two masses, Van der Pol, forced" : "two masses, Van der Pol, free";
  if (forced) {
    out.tables = {"9"};
    out.notes = {kLengthNote};
    out.parameters = {{"c1", "N s/m", 21, {}, 4.6e-4},     {"k1", "N/m", 7241, {}, 2.1e-5},
                      {"c3_1", "N s/m^3", 50, {}, 2.9e-5}, {"c2", "N s/m", 60, {}, 7.6e-5},
                      {"k2", "N/m", 14900, {}, 9.0e-6},    {"c3_2", "N s/m^3", 150, {}, 1.3e-4}};
    return out;
  }
  out.tables = {"11"};
  out.notes = {"Not published, assumed: time step 0.001 s, 3 s."};
  out.resolution = {.step_s = 0.001, .samples = 3000, .substeps = 4};
  out.parameters = {{"c1", "N s/m", 21, {}, 4.6e-5},     {"k1", "N/m", 7241, {}, 6.9e-6},
                    {"c3_1", "N s/m^3", 50, {}, 1.7e-2}, {"c2", "N s/m", 60, {}, 2.0e-5},
                    {"k2", "N/m", 14900, {}, 2.1e-6},    {"c3_2", "N s/m^3", 150, {}, 6.3e-2}};
  return out;
}

PublishedCase duffing_van_der_pol_chain_case() {
  PublishedCase out = with_duffing(true);
  out.tables = {"18"};
  out.title = "two masses, Duffing and Van der Pol, forced";
  out.chain.links[0].element.w = 50;
  out.chain.links[1].element.w = 150;
  return out;
}

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
