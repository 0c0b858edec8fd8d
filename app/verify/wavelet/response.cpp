// SPDX-License-Identifier: MIT
#include "app/verify/wavelet/response.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "app/verify/wavelet/rows.hpp"
#include "published/wavelet/daubechies.hpp"

namespace dampline::app {
namespace {

using sim::reference::Chain;
using sim::reference::Element;
using sim::reference::Signum;
using sim::reference::Trajectory;

constexpr std::size_t kSamples = 512;
constexpr Eigen::Index kWindowEquations = 32;
constexpr double kSharpnessSpm = 1500.0;

const std::vector<ElementTerm>& vocabulary() {
  static const std::vector<ElementTerm> all{
      {"c", &Element::c, [](double, double v) { return v; }},
      {"k", &Element::k, [](double x, double) { return x; }},
      {"k2", &Element::k2, [](double x, double) { return x * x; }},
      {"c2", &Element::c2, [](double, double v) { return v * v; }},
      {"k3", &Element::k3, [](double x, double) { return x * x * x; }},
      {"x^2 x'", &Element::w, [](double x, double v) { return x * x * v; }},
      {"x'^3", &Element::c3, [](double, double v) { return v * v * v; }},
      {"e", &Element::e, [](double, double v) { return std::tanh(kSharpnessSpm * v); }}};
  return all;
}

/// What the rows' gate watches.
using Gated = CoulombTerms<ExactSign>;

/// All equations of a run: regressors and right-hand side, the masses' equations of an instant one
/// after the other.
struct Equations {
  Eigen::MatrixXd regressors;
  Eigen::VectorXd target;
};

/// The gate is on where there is friction.
template <int Dof, class Model>
Equations equations_of(const Trajectory& truth, const PublishedCase& published,
                       const std::vector<ElementTerm>& terms) {
  const auto count = static_cast<Eigen::Index>(terms.size());
  Equations out{Eigen::MatrixXd::Zero(Dof * static_cast<Eigen::Index>(kSamples), Dof * count),
                Eigen::VectorXd::Zero(Dof * static_cast<Eigen::Index>(kSamples))};
  Eigen::Index at = 0;
  const auto take = [&](const MotionRow<Model>& row) {
    double x = row.deflection_m[0];
    double v = row.velocity_mps[0];
    for (Eigen::Index e = 0; e < Dof; ++e) {
      for (Eigen::Index i = 0; i < count; ++i) {
        const double value = terms[static_cast<std::size_t>(i)].value(x, v);
        out.regressors(at + e, e * count + i) = value;
        if (e > 0) out.regressors(at + e - 1, e * count + i) = -value;
      }
      out.target[at + e] = row.target_n[static_cast<std::size_t>(e)];
      if (e + 1 < Dof) {
        x = row.deflection_m[static_cast<std::size_t>(e) + 1] - row.deflection_m[0];
        v = row.velocity_mps[static_cast<std::size_t>(e) + 1] - row.velocity_mps[0];
      }
    }
    at += Dof;
  };
  const bool friction = published.chain.links[0].element.has_friction();
  for_each_row<MotionRows<D8, Model>>(measured<Dof>(truth, published.chain.mass_kg), Model{}, take,
                                      friction ? Gate::kOn : Gate::kOff);
  out.regressors.conservativeResize(at, Eigen::NoChange);
  out.target.conservativeResize(at);
  return out;
}

Eigen::VectorXd mean_over_windows(const Equations& all) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(all.regressors.cols());
  double windows = 0.0;
  for (Eigen::Index from = 0; from + kWindowEquations <= all.target.size();
       from += kWindowEquations) {
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr{
        all.regressors.middleRows(from, kWindowEquations)};
    if (qr.rank() < all.regressors.cols()) continue;
    sum += qr.solve(all.target.segment(from, kWindowEquations));
    windows += 1.0;
  }
  return sum / windows;
}

Chain estimated_chain(Chain chain, const std::vector<ElementTerm>& terms,
                      const Eigen::VectorXd& theta) {
  Eigen::Index at = 0;
  for (sim::reference::Link& link : chain.links) {
    link.element = {.signum = Signum::kTanh, .sharpness_spm = kSharpnessSpm};
    for (const ElementTerm& term : terms) link.element.*term.coefficient = theta[at++];
  }
  return chain;
}

double mse_percent(const std::vector<double>& truth, const std::vector<double>& estimate) {
  const double mean =
      std::accumulate(truth.begin(), truth.end(), 0.0) / static_cast<double>(truth.size());
  double error = 0.0;
  double power = 0.0;
  for (std::size_t n = 0; n < truth.size(); ++n) {
    error += (truth[n] - estimate[n]) * (truth[n] - estimate[n]);
    power += (truth[n] - mean) * (truth[n] - mean);
  }
  const double out = 100.0 * error / power;
  return std::isfinite(out) ? out : std::numeric_limits<double>::infinity();
}

}  // namespace

std::vector<ElementTerm> element_terms(const std::vector<std::string>& names) {
  std::vector<ElementTerm> out;
  for (const std::string& name : names) {
    const auto at = std::find_if(vocabulary().begin(), vocabulary().end(),
                                 [&](const ElementTerm& term) { return name == term.name; });
    if (at == vocabulary().end()) throw std::invalid_argument{"no term " + name};
    out.push_back(*at);
  }
  return out;
}

std::vector<double> response_mse_percent(const PublishedCase& published,
                                         const std::vector<ElementTerm>& terms) {
  PublishedCase run = published;
  run.resolution.samples = kSamples;
  const Trajectory truth = run.simulate();
  const Equations all = run.chain.mass_kg.size() == 1
                            ? equations_of<1, SingleModel<Gated>>(truth, run, terms)
                            : equations_of<2, ChainModel<Gated, Gated>>(truth, run, terms);
  const Chain estimated = estimated_chain(run.chain, terms, mean_over_windows(all));
  const Trajectory response = sim::reference::simulate(estimated, run.start, run.resolution);
  std::vector<double> out;
  for (std::size_t d = 0; d < truth.accel_mps2.size(); ++d)
    out.push_back(mse_percent(truth.accel_mps2[d], response.accel_mps2[d]));
  return out;
}

}  // namespace dampline::app
