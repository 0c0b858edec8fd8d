// SPDX-License-Identifier: MIT
#include "app/verify/wavelet/published_case.hpp"

namespace dampline::app {
namespace {

using sim::reference::Element;
using sim::reference::Input;
using sim::reference::Link;
using sim::reference::Start;

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

}  // namespace

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

}  // namespace dampline::app
