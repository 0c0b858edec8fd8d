// SPDX-License-Identifier: MIT
#include "tests/proof/golden.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <sstream>

namespace dampline::proof {
namespace {

void add(Figures& figures, const std::string& name, const Estimate& estimate) {
  figures.emplace_back(name, estimate.value);
  figures.emplace_back(name + ".std", estimate.std);
}

void add_count(Figures& figures, const std::string& name, std::uint64_t count) {
  figures.emplace_back(name, static_cast<double>(count));
}

}  // namespace

Figures figures_of(const Snapshot& snapshot) {
  Figures figures;
  add(figures, "coulomb_n", snapshot.coulomb_n);
  add(figures, "stiffness_npm", snapshot.stiffness_npm);
  add(figures, "viscous_nspm", snapshot.viscous_nspm);
  add(figures, "law_width_mps", snapshot.law_width_mps);
  for (std::size_t i = 0; i < snapshot.curve.size(); ++i) {
    const CurvePoint& point = snapshot.curve[i];
    const std::string name = fmt::format("curve[{}]", i);
    add(figures, name + ".force_n", {point.force_n, point.std_n});
    add_count(figures, name + ".samples", point.samples);
  }
  figures.emplace_back("nmse", snapshot.nmse);
  figures.emplace_back("held_out_nmse", snapshot.held_out_nmse);
  figures.emplace_back("velocity_rms_mps", snapshot.velocity_rms_mps);
  figures.emplace_back("noise_mps2", snapshot.noise_mps2);
  add_count(figures, "rows", snapshot.counts.rows);
  add_count(figures, "blocks", snapshot.counts.blocks);
  return figures;
}

std::string write_figures(const Figures& figures) {
  std::string text;
  for (const auto& [name, value] : figures) text += fmt::format("{} {:a}\n", name, value);
  return text;
}

Figures read_figures(const std::string& text) {
  Figures figures;
  std::istringstream words{text};
  for (std::string name, value; words >> name >> value;) {
    figures.emplace_back(name, std::strtod(value.c_str(), nullptr));
  }
  return figures;
}

std::uint64_t hash_figures(const Figures& figures) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : write_figures(figures)) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  }
  return hash;
}

}  // namespace dampline::proof
