// SPDX-License-Identifier: MIT
#include "app/verify/fokker_planck_cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <memory>

#include "app/verify/printed/printed.hpp"
#include "dampline/density/fokker_planck.hpp"
#include "dampline/numeric/cholesky.hpp"
#include "published/phase/scaling.hpp"
#include "sim_hw/simulation.hpp"
#include "sim_hw/white_input.hpp"

namespace dampline::app {
namespace {

constexpr double kLengthS = 300.0;
constexpr std::uint64_t kSeeds = 4;
constexpr double kVelocityRmsMps = 8.0e-3;
using Figures = std::vector<FokkerPlanckFigure>;

/// Magnitudes of the force for v > 0 and v < 0.
struct Branches {
  double positive_n, negative_n;
};

/// The published means: those of the simulated trucks.
Branches mean_forces(sim::Load load) {
  const sim::TruckConfig truck = sim::truck_of(load);
  return {truck.friction_positive_n, truck.friction_negative_n};
}

/// The jump at v = 0 of a published table: its curves depart from it by 2e-4 at most.
Branches forces_of_table(const std::string& name) {
  const auto force_n = [&](const char* side) {
    return 1e3 *
           std::abs(printed_table(kisilowski_urbanski(), name + side).at("11", "force").value);
  };
  return {force_n(" v>0"), force_n(" v<0")};
}

sim::WhiteInputConfig white(sim::Load load, const Branches& force, std::uint64_t seed) {
  const sim::TruckConfig truck = sim::truck_of(load);
  const double level_n = 0.5 * (force.positive_n + force.negative_n);
  sim::WhiteInputConfig out;
  out.seed = seed;
  out.moving_mass_kg = truck.moving_mass_kg;
  out.stiffness_npm = truck.stiffness_npm;
  out.friction_positive_n = force.positive_n;
  out.friction_negative_n = force.negative_n;
  out.input_level = sim::input_level_for(kVelocityRmsMps, level_n, truck.moving_mass_kg);
  return out;
}

sim::WhiteInputConfig white(sim::Load load, std::uint64_t seed) {
  return white(load, mean_forces(load), seed);
}

double level_of(const sim::WhiteInputConfig& c) {
  return 0.5 * (c.friction_positive_n + c.friction_negative_n);
}

constexpr FokkerPlanckConfig kAbsolute{.deflection_is_absolute = true};

void feed(const sim::WhiteInputConfig& config, std::initializer_list<FokkerPlanck*> to) {
  sim::WhiteInput source{config};
  const auto samples = static_cast<int>(kLengthS * sim::WhiteInput::sample_rate_hz());
  for (int i = 0; i < samples; ++i) {
    const Motion motion = source.next();
    for (FokkerPlanck* one : to) one->update(motion);
  }
}

std::unique_ptr<FokkerPlanck> run(const sim::WhiteInputConfig& config) {
  auto out = std::make_unique<FokkerPlanck>(kAbsolute);
  feed(config, {out.get()});
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
  add("the paper's form without |v| near 0", worst_paper, 0.08);
  add("the known input", worst_known, 0.05);
}

OverRuns over(const std::vector<double>& values) {
  RunningMean mean;
  for (const double value : values) mean.add(value);
  return {mean.mean(), std::sqrt(mean.variance())};
}

/// Nine runs of a load, with true deflection and without its mean.
struct LoadRuns {
  sim::WhiteInputConfig config;
  std::vector<std::unique_ptr<FokkerPlanck>> absolute, free;
};

LoadRuns runs_of(sim::Load load, const Branches& force, std::uint64_t first_seed) {
  LoadRuns out{.config = white(load, force, first_seed), .absolute = {}, .free = {}};
  for (std::uint64_t i = 0; i < kRunsOfTable; ++i) {
    out.absolute.push_back(std::make_unique<FokkerPlanck>(kAbsolute));
    out.free.push_back(std::make_unique<FokkerPlanck>(FokkerPlanckConfig{}));
    feed(white(load, force, first_seed + i), {out.absolute.back().get(), out.free.back().get()});
  }
  return out;
}

/// A method, and what is promised of its mean; 0: nothing.
struct Form {
  MethodResult FokkerPlanckEstimates::*method;
  double bound;
};

void add_mean_forces(const LoadRuns& runs, const char* load, Figures& figures) {
  const PrintedTable& printed = printed_table(kisilowski_urbanski(), "mean forces");
  const auto add = [&](const char* column, double sign, const auto& data, const char* with,
                       const std::string& remark, const Form& form) {
    std::vector<double> forces;
    forces.reserve(data.size());
    for (const auto& one : data)
      forces.push_back(branch_force(
          one->estimates(runs.config.moving_mass_kg, runs.config.stiffness_npm).*form.method,
          sign));
    const OverRuns found = over(forces);
    const double truth =
        sign > 0.0 ? runs.config.friction_positive_n : runs.config.friction_negative_n;
    const bool promised = form.bound > 0.0;
    figures.push_back(
        {.quantity = fmt::format("mean {} of nine {} runs, N, {}", column, load, with),
         .published = printed.text(load, column),
         .computed = fmt::format("{:.0f} +- {:.0f}", found.mean, found.std),
         .remark =
             promised ? fmt::format("{}; promised: {:.1f} %", remark, 100.0 * form.bound) : remark,
         .promised = promised,
         .met = !promised || std::abs(found.mean / truth - 1.0) <= form.bound});
  };
  // The weak form knows the input's level and not its chance, which leaves 2.3 % of a run of 300 s:
  // 0.8 % of the mean of nine, and 24 seeds +0.2 and -0.6 +- 0.5 % laden, +0.5 and -0.2 +- 0.5 %
  // empty. The bound is four deviations.
  constexpr Form kWeak{&FokkerPlanckEstimates::weak, 0.03};
  constexpr Form kWeakWithoutMean{&FokkerPlanckEstimates::weak, 0.0};
  constexpr Form kKnown{&FokkerPlanckEstimates::known_input, 0.001};
  const char* const simulated =
      "weak form on simulations with the published means, which knows the input's level and not "
      "its chance; +-: of a run";
  const char* const known = "the same simulations with the input as measured";
  const char* const lost =
      "not reproducible from accelerations: a constant force moves only the mean deflection, so "
      "only (F1 + F2) / 2 is observable";
  add("F1", 1.0, runs.absolute, "true deflection", simulated, kWeak);
  add("F2", -1.0, runs.absolute, "true deflection", simulated, kWeak);
  add("F1", 1.0, runs.absolute, "true deflection, known input", known, kKnown);
  add("F2", -1.0, runs.absolute, "true deflection, known input", known, kKnown);
  add("F1", 1.0, runs.free, "deflection without its mean", lost, kWeakWithoutMean);
  add("F2", -1.0, runs.free, "deflection without its mean", lost, kWeakWithoutMean);
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

/// Ends of the published intervals for v > 0.
double published_reach_mps(const std::string& name) {
  return printed_table(kisilowski_urbanski(), name + " v>0").at("10", "XK").value;
}

PaperForm paper_form(const LoadRuns& runs, const FokkerPlanck& data, double exclude,
                     double reach_mps, std::size_t segments = kPaperSegments) {
  const double bandwidth_mps = 0.25 * data.velocity_rms_mps();
  return data.paper_form(runs.config.moving_mass_kg, runs.config.stiffness_npm, bandwidth_mps,
                         exclude * bandwidth_mps, reach_mps, segments);
}

constexpr double kExcludedBandwidths = 3.0;

/// Line `i` of side `s` over all runs; the line after the last segment is the jump at v = 0.
PaperLine line_of(const std::vector<PaperForm>& forms, std::size_t s, std::size_t i,
                  double half_mass_kg) {
  const double sign = s == 1 ? 1.0 : -1.0;
  std::vector<double> slopes;
  std::vector<double> forces;
  PaperLine out;
  for (const PaperForm& form : forms) {
    if (i == kPaperSegments) {
      slopes.push_back(0.0);
      forces.push_back(half_mass_kg * form.offset_mps2[s]);
      continue;
    }
    const PaperSegment& segment = form.segments[s][i];
    out.from_mps = sign * segment.from_mps;
    out.to_mps = sign * segment.to_mps;
    slopes.push_back(sign * half_mass_kg * segment.slope_ps);
    forces.push_back(half_mass_kg * segment.alpha_mps2);
  }
  out.slope_nspm = over(slopes);
  out.force_n = over(forces);
  return out;
}

PaperTable table(const LoadRuns& runs, const char* name, const char* caption) {
  const double reach_mps = published_reach_mps(name);
  std::vector<PaperForm> forms;
  for (const auto& data : runs.absolute)
    forms.push_back(paper_form(runs, *data, kExcludedBandwidths, reach_mps));
  PaperTable out{.name = name,
                 .caption = caption,
                 .half_mass_kg = 0.5 * runs.config.moving_mass_kg,
                 .simulated_n = {runs.config.friction_negative_n, runs.config.friction_positive_n},
                 .whole = paper_form(runs, *runs.absolute.front(), 0.0, reach_mps),
                 .excluded = forms.front()};
  for (std::size_t s = 0; s < 2; ++s) {
    const PrintedTable& printed =
        printed_table(kisilowski_urbanski(), std::string{name} + (s == 1 ? " v>0" : " v<0"));
    for (std::size_t i = 0; i <= kPaperSegments; ++i) {
      out.lines[s].push_back(line_of(forms, s, i, out.half_mass_kg));
      out.lines[s].back().published = &printed.rows[i];
    }
  }
  return out;
}

/// What the number of segments does: the level, and how far the curve departs from it.
void add_segments(const LoadRuns& runs, Figures& figures) {
  const double half_mass_kg = 0.5 * runs.config.moving_mass_kg;
  for (const std::size_t segments : {std::size_t{5}, kPaperSegments, kMostPaperSegments}) {
    std::vector<double> levels;
    double largest_n = 0.0;
    for (const auto& data : runs.absolute) {
      const PaperForm form =
          paper_form(runs, *data, kExcludedBandwidths, published_reach_mps("1"), segments);
      levels.push_back(half_mass_kg * form.level_mps2());
      for (std::size_t s = 0; s < 2; ++s) {
        for (std::size_t i = 0; i < form.used; ++i)
          largest_n = std::max(largest_n, half_mass_kg * std::abs(form.segments[s][i].alpha_mps2 -
                                                                  form.mean_mps2[s]));
      }
    }
    const OverRuns level = over(levels);
    figures.push_back(
        {.quantity = fmt::format("level with k = {} segments in all, laden, N", 2 * segments),
         .published = segments == kPaperSegments ? "8356" : "-",
         .computed = fmt::format("{:.0f} +- {:.0f}", level.mean, level.std),
         .remark = fmt::format("{}the curve departs from its branch's mean by up to {:.0f} N",
                               segments == kPaperSegments ? "k as published; (F1 + F2) / 2; " : "",
                               largest_n)});
  }
}

/// Largest departure of a branch from its mean, relative.
double flatness(const PaperForm& form) {
  double largest = 0.0;
  for (std::size_t s = 0; s < 2; ++s) {
    for (std::size_t i = 0; i < form.used; ++i) {
      const double alpha_mps2 = form.segments[s][i].alpha_mps2;
      largest = std::max(largest, std::abs(alpha_mps2 / form.mean_mps2[s] - 1.0));
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
  const LoadRuns laden = runs_of(sim::Load::kLaden, mean_forces(sim::Load::kLaden), 541);
  const LoadRuns empty = runs_of(sim::Load::kEmpty, mean_forces(sim::Load::kEmpty), 561);
  FokkerPlanckCases out;
  out.tables = {
      table(runs_of(sim::Load::kLaden, forces_of_table("1"), 641), "1", "fully laden, 80 km/h"),
      table(runs_of(sim::Load::kEmpty, forces_of_table("2"), 661), "2", "empty, 60 km/h")};
  add_mean_forces(laden, "laden", out.figures);
  add_mean_forces(empty, "empty", out.figures);
  add_white_input_levels(out.figures);
  add_segments(laden, out.figures);
  add_scale_factors(out.tables[0], "1.830", "0.778", out.figures);
  add_scale_factors(out.tables[1], "0.003205", "0.000604", out.figures);
  add_modulation(out.figures);
  add_divergence(out.figures);
  return out;
}

}  // namespace dampline::app
