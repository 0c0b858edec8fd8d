// SPDX-License-Identifier: MIT
#pragma once
#include <fmt/format.h>

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "app/verify/reference/chain.hpp"
#include "app/wavelet/measured.hpp"

// Records of systems whose truth is known, by the studies' integrator of order eight in extended
// precision, which shares no code with the rows.
namespace dampline::app::wavelet::test {

using sim::reference::Chain;
using sim::reference::Element;
using sim::reference::Input;
using sim::reference::Trajectory;

struct Noise {
  double deflection_m{0.0};
  double force_n{0.0};
};

inline Measured measured_of(const Trajectory& truth, const Noise& noise = {},
                            std::uint64_t seed = 1) {
  std::mt19937_64 random{seed};
  std::normal_distribution<double> normal;
  Measured out;
  out.name = "simulated";
  out.masses = static_cast<int>(truth.deflection_m.size());
  out.step_s = truth.step_s;
  const std::size_t count = truth.deflection_m.front().size();
  for (std::size_t i = 0; i < count; ++i)
    out.time_s.push_back(static_cast<double>(i) * truth.step_s);
  for (std::size_t m = 0; m < truth.deflection_m.size(); ++m)
    for (std::size_t i = 0; i < count; ++i) {
      out.deflection_m[m].push_back(truth.deflection_m[m][i] + noise.deflection_m * normal(random));
      out.force_n[m].push_back(truth.force_n[m][i] + noise.force_n * normal(random));
    }
  out.stretches = {{0, count}};
  out.duration_s = out.time_s.back();
  return out;
}

/// A hardening oscillator of 0.8 Hz that four tones keep moving between 0.2 and 1.5 Hz.
inline Element duffing() { return {.k = 25, .k3 = 40, .c = sim::reference::Real(0.6)}; }
inline Input four_tones(double amplitude_n = 4.0) {
  Input out;
  for (const double rate : {1.3, 3.1, 5.3, 8.9}) out.push_back({amplitude_n, rate, 0});
  return out;
}
inline Trajectory driven(const Element& element, double mass_kg, std::size_t samples,
                         double step_s = 0.02, double amplitude_n = 4.0) {
  Chain chain = sim::reference::single(element, four_tones(amplitude_n));
  chain.mass_kg = {mass_kg};
  return sim::reference::simulate(chain, {}, {.step_s = step_s, .samples = samples});
}

/// Two hardening elements, the second softer and without a cubic part of its own; both masses
/// driven.
inline Trajectory driven_chain(std::size_t samples) {
  Chain chain;
  chain.mass_kg = {2, 1};
  chain.links = {{sim::reference::Link::kGround, 0, {.k = 60, .k3 = 30, .c = 1}},
                 {0, 1, {.k = 20, .c = sim::reference::Real(0.4)}}};
  chain.inputs = {four_tones(5.0), {{3.0, 2.3, 0}, {3.0, 7.1, 0}}};
  return sim::reference::simulate(chain, {}, {.step_s = 0.02, .samples = samples});
}

/// As a file with a header of one's own.
inline std::string csv_of(const Measured& measured, const std::string& header) {
  std::string out = header + "\n";
  for (std::size_t i = 0; i < measured.samples(); ++i) {
    out += fmt::format("{:.6f}", measured.time_s[i]);
    for (std::size_t m = 0; m < static_cast<std::size_t>(measured.masses); ++m)
      out += fmt::format(",{:.15g}", measured.deflection_m[m][i]);
    for (std::size_t m = 0; m < static_cast<std::size_t>(measured.masses); ++m)
      out += fmt::format(",{:.15g}", measured.force_n[m][i]);
    out += '\n';
  }
  return out;
}

}  // namespace dampline::app::wavelet::test
