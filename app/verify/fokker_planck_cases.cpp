// SPDX-License-Identifier: MIT
#include "app/verify/fokker_planck_cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "dampline/density/fokker_planck.hpp"
#include "dampline/numeric/cholesky.hpp"
#include "sim_hw/simulation.hpp"
#include "sim_hw/white_input.hpp"

namespace dampline::app {
namespace {

constexpr double kLengthS = 300.0;
constexpr std::uint64_t kSeeds = 4;
constexpr double kVelocityRmsMps = 8.0e-3;
using Figures = std::vector<FokkerPlanckFigure>;

sim::WhiteInputConfig white(sim::Load load, std::uint64_t seed) {
  const sim::TruckConfig truck = sim::truck_of(load);
  const double level_n = 0.5 * (truck.friction_positive_n + truck.friction_negative_n);
  sim::WhiteInputConfig out;
  out.seed = seed;
  out.moving_mass_kg = truck.moving_mass_kg;
  out.stiffness_npm = truck.stiffness_npm;
  out.friction_positive_n = truck.friction_positive_n;
  out.friction_negative_n = truck.friction_negative_n;
  out.input_level = sim::input_level_for(kVelocityRmsMps, level_n, truck.moving_mass_kg);
  return out;
}

double level_of(const sim::WhiteInputConfig& c) {
  return 0.5 * (c.friction_positive_n + c.friction_negative_n);
}

std::unique_ptr<FokkerPlanck> run(const sim::WhiteInputConfig& config, bool absolute = true) {
  auto out = std::make_unique<FokkerPlanck>(FokkerPlanckConfig{.deflection_is_absolute = absolute});
  sim::WhiteInput source{config};
  const auto samples = static_cast<int>(kLengthS * sim::WhiteInput::sample_rate_hz());
  for (int i = 0; i < samples; ++i) out->update(source.next());
  return out;
}

std::string percent(double ratio) { return fmt::format("{:+.1f} %", 100.0 * (ratio - 1.0)); }

/// Force of a curve over |v| > 3 mm/s of one sign, weighted by the samples.
double branch_force(const MethodResult& result, double sign) {
  double sum = 0.0;
  double weight = 0.0;
  for (std::size_t i = 0; i < result.points; ++i) {
    const CurvePoint& point = result.curve[i];
    if (sign * point.velocity_mps < 2.9e-3) continue;
    sum += static_cast<double>(point.samples) * std::abs(point.force_n);
    weight += static_cast<double>(point.samples);
  }
  return weight > 0.0 ? sum / weight : 0.0;
}

void add_white_input_levels(Figures& figures) {
  double worst_weak = 0.0;
  double worst_paper = 0.0;
  double worst_known = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const auto config = white(sim::Load::kLaden, 500 + seed);
    const auto found = run(config)->estimates(config.moving_mass_kg, config.stiffness_npm);
    const auto note = [&](double& worst, const MethodResult& method) {
      const double error = std::abs(method.level_n.value / level_of(config) - 1.0);
      worst = std::max(worst, method.verdict.trusted ? error : 1.0e3);
    };
    note(worst_weak, found.weak);
    note(worst_paper, found.paper);
    note(worst_known, found.known_input);
  }
  const auto add = [&](const char* method, double worst, double limit) {
    figures.push_back({.quantity = fmt::format("level by {}, largest error of {} white-input runs",
                                               method, kSeeds),
                       .published = "-",
                       .computed = fmt::format("{:.1f} %", 100.0 * worst),
                       .remark = fmt::format("promised: {:.0f} %", 100.0 * limit),
                       .promised = true,
                       .met = worst <= limit});
  };
  add("the weak form", worst_weak, 0.03);
  add("the paper's form without |v| near 0", worst_paper, 0.05);
  add("the known input", worst_known, 0.05);
}

void add_branches(sim::Load load, const char* name, Figures& figures) {
  const auto config = white(load, 511);
  const auto absolute = run(config)->estimates(config.moving_mass_kg, config.stiffness_npm);
  const auto free = run(config, false)->estimates(config.moving_mass_kg, config.stiffness_npm);
  const std::string published =
      fmt::format("{:.0f} / {:.0f}", config.friction_positive_n, config.friction_negative_n);
  const auto forces = [](const MethodResult& method) {
    return fmt::format("{:.0f} / {:.0f}", branch_force(method, 1.0), branch_force(method, -1.0));
  };
  figures.push_back({.quantity = fmt::format("F1 / F2, {}, N, true deflection", name),
                     .published = published,
                     .computed = forces(absolute.weak),
                     .remark = "weak form on a simulation with the published values"});
  figures.push_back({.quantity = fmt::format("F1 / F2, {}, N, deflection without its mean", name),
                     .published = published,
                     .computed = forces(free.weak),
                     .remark = "not reproducible from accelerations: a constant force moves only "
                               "the mean deflection, so only (F1 + F2) / 2 is observable"});
}

/// psi_i = eta_i / xi_i with pseudo-random xi_i, fitted by a polynomial in y; returns the factor
/// by which its mean square misses the input's level.
double literal_modulation(const sim::WhiteInputConfig& config, std::uint64_t xi_seed) {
  constexpr int kTerms = static_cast<int>(Modulation::kTerms);
  using System = Cholesky<kTerms>;
  System::Matrix gram = System::Matrix::Zero();
  System::Vector right = System::Vector::Zero();
  sim::WhiteInput source{config};
  sim::Random xi{xi_seed, sim::Stream::kSensors};
  const auto powers = [](double deflection_m) {
    System::Vector out;
    for (int m = 0; m < kTerms; ++m) out[m] = std::pow(1.0e3 * deflection_m, m);
    return out;
  };
  const auto samples = static_cast<int>(kLengthS * sim::WhiteInput::sample_rate_hz());
  for (int i = 0; i < samples; ++i) {
    const Motion motion = source.next();
    const System::Vector y = powers(motion.deflection_m);
    gram += y * y.transpose();
    right += y * (motion.input_mps2() / xi.normal());
  }
  System cholesky;
  if (!cholesky.factor(gram, kTerms)) return 0.0;
  cholesky.solve(right);
  const double mean_square = right.dot(gram * right) / samples;
  return mean_square / config.input_level;
}

void add_modulation(Figures& figures) {
  const auto config = white(sim::Load::kLaden, 521);
  std::string factors;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    factors += fmt::format("{}{:.3g}", seed == 1 ? "" : ", ", literal_modulation(config, seed));
  }
  figures.push_back({.quantity = "level of psi^2 by eta / xi over the true level, 3 draws of xi",
                     .published = "-",
                     .computed = factors,
                     .remark =
                         "not reproducible: the mean of |1 / xi| does not exist, and the "
                         "sampling rate is missing; here psi^2 is the input's spectral level"});
}

void add_divergence(Figures& figures) {
  const auto config = white(sim::Load::kLaden, 531);
  const auto data = run(config);
  for (const double bandwidth_mps : {4.0e-3, 2.0e-3, 1.0e-3, 0.5e-3}) {
    const auto form = [&](double excluded) {
      return data->paper_form(config.moving_mass_kg, config.stiffness_npm, bandwidth_mps, excluded);
    };
    const PaperForm whole = form(0.0);
    const double scale = 0.5 * config.moving_mass_kg / level_of(config);
    figures.push_back(
        {.quantity =
             fmt::format("J at zero slopes, and level, at {:.1f} mm/s", 1e3 * bandwidth_mps),
         .published = "-",
         .computed =
             fmt::format("{:.3g}, {}", whole.integrals.aa, percent(scale * whole.level_mps2())),
         .remark = fmt::format("without |v| < 3 bandwidths: {}",
                               percent(scale * form(3.0 * bandwidth_mps).level_mps2()))});
  }
  figures.push_back({.quantity = "J as the bins shrink",
                     .published = "a minimum",
                     .computed = "grows without bound",
                     .remark = "p2'' has a delta at v = 0 under friction, of which J takes the "
                               "square; the exclusion repairs it"});
}

PaperTable table(sim::Load load, const char* name, const char* caption) {
  const auto config = white(load, 541);
  const auto data = run(config);
  const double bandwidth_mps = 0.25 * data->velocity_rms_mps();
  const auto form = [&](double excluded_mps) {
    return data->paper_form(config.moving_mass_kg, config.stiffness_npm, bandwidth_mps,
                            excluded_mps);
  };
  return {.name = name,
          .caption = caption,
          .half_mass_kg = 0.5 * config.moving_mass_kg,
          .whole = form(0.0),
          .excluded = form(3.0 * bandwidth_mps)};
}

/// Largest departure of a branch from its mean, relative.
double flatness(const PaperForm& form) {
  double largest = 0.0;
  for (std::size_t s = 0; s < 2; ++s) {
    for (const PaperSegment& segment : form.segments[s]) {
      largest = std::max(largest, std::abs(segment.alpha_mps2 / form.mean_mps2[s] - 1.0));
    }
  }
  return largest;
}

void add_scale_factors(const PaperTable& t, const char* positive, const char* negative,
                       Figures& figures) {
  figures.push_back({.quantity = fmt::format("Table {}: force over alpha, v > 0 / v < 0", t.name),
                     .published = fmt::format("{} / {}", positive, negative),
                     .computed = fmt::format("{0:.0f} / {0:.0f} kg", t.half_mass_kg),
                     .remark = "not reproducible: force = s (offset - sum of slopes) gives all "
                               "digits, but s has to be M / 2 on both sides"});
  figures.push_back({.quantity = fmt::format("Table {}: curve's departure from a constant", t.name),
                     .published = "2e-4",
                     .computed = fmt::format("{:.2g}", flatness(t.excluded)),
                     .remark = "not reproducible: in 300 s the slopes scatter by more; the "
                               "published offset has taken everything"});
}

}  // namespace

FokkerPlanckCases fokker_planck_cases() {
  FokkerPlanckCases out;
  out.tables = {
      table(sim::Load::kLaden, "1", "laden truck, white input, 300 s"),
      table(sim::Load::kEmpty, "2", "empty truck, white input, 300 s"),
  };
  add_white_input_levels(out.figures);
  add_branches(sim::Load::kLaden, "laden", out.figures);
  add_branches(sim::Load::kEmpty, "empty", out.figures);
  add_scale_factors(out.tables[0], "1.830", "0.778", out.figures);
  add_scale_factors(out.tables[1], "0.003205", "0.000604", out.figures);
  add_modulation(out.figures);
  add_divergence(out.figures);
  return out;
}

}  // namespace dampline::app
