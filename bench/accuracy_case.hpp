// SPDX-License-Identifier: MIT
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "dampline/damping/estimator.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::bench {

/// A condition of the accuracy tables: a simulated car whose parameters are known.
struct AccuracyCase {
  std::string name;
  sim::SimulationConfig simulation;
  [[nodiscard]] double coulomb_n() const {
    const auto& t = simulation.truck;
    return 0.5 * t.friction_scale * (t.friction_positive_n + t.friction_negative_n);
  }
};

/// The four conditions of the README's table: good track (ORE B176 low), 0.02 m/s^2 of noise.
inline std::vector<AccuracyCase> standard_cases() {
  const auto make = [](const char* name, bool laden, double speed_kmh) {
    const auto load = laden ? sim::Load::kLaden : sim::Load::kEmpty;
    return AccuracyCase{name, sim::reference_run(load, speed_kmh, 0)};
  };
  return {make("laden 80", true, 80), make("laden 60", true, 60), make("empty 80", false, 80),
          make("empty 60", false, 60)};
}

/// Mean and largest magnitude.
struct Spread {
  double sum{0.0};
  double largest{0.0};
  int count{0};
  void add(double x) {
    sum += std::abs(x);
    largest = std::max(largest, std::abs(x));
    ++count;
  }
  [[nodiscard]] std::string percent(int decimals) const {
    return fmt::format("{:.{}f} / {:.{}f}", 100.0 * sum / count, decimals, 100.0 * largest,
                       decimals);
  }
};

/// Relative errors of one estimate, as fractions of the truth.
struct Errors {
  double coulomb{0.0};
  double stiffness{0.0};
  double false_viscous{0.0};  ///< viscous force at the rms velocity, of Fc
  double curve{0.0};          ///< relative L2 over the visited |v| > 3 mm/s
  double coulomb_sigmas{0.0};
  double stiffness_sigmas{0.0};
  Snapshot snapshot;
};

struct RunErrors {
  std::vector<Errors> at;  ///< one per length
  double velocity{0.0};    ///< rms error / rms
  double deflection{0.0};  ///< rms error / rms, means removed
};

/// Force of the curve at a positive velocity.
inline double curve_force_n(const Snapshot& s, double v_mps) {
  double left_v = 0.0;
  double left_f = s.curve_force_at_zero_n;
  for (std::size_t i = 0; i < kCurveSegments; ++i) {
    const CurvePoint& p = s.curve[i];
    if (v_mps <= p.velocity_mps || i + 1 == kCurveSegments) {
      return left_f + (v_mps - left_v) * (p.force_n - left_f) / (p.velocity_mps - left_v);
    }
    left_v = p.velocity_mps;
    left_f = p.force_n;
  }
  return left_f;
}

/// How often each velocity was visited, in steps of 0.5 mm/s.
struct Visits {
  static constexpr double kStepMps = 0.5e-3;
  std::array<double, 400> count{};
  void add(double velocity_mps) {
    const auto i = static_cast<std::size_t>(std::abs(velocity_mps) / kStepMps);
    if (i < count.size()) count[i] += 1.0;
  }
};

inline double curve_error(const Snapshot& s, const AccuracyCase& c, const Visits& visits) {
  double error = 0.0;
  double total = 0.0;
  for (std::size_t i = 6; i < visits.count.size(); ++i) {
    const double v = (static_cast<double>(i) + 0.5) * Visits::kStepMps;
    const double truth = c.coulomb_n() * std::tanh(v / c.simulation.truck.law_width_mps);
    const double d = curve_force_n(s, v) - truth;
    error += visits.count[i] * d * d;
    total += visits.count[i] * truth * truth;
  }
  return std::sqrt(error / total);
}

inline Errors errors_of(const Snapshot& s, const AccuracyCase& c, const Visits& visits) {
  const double fc = c.coulomb_n();
  const double k = c.simulation.truck.stiffness_npm;
  return {.coulomb = s.coulomb_n.value / fc - 1.0,
          .stiffness = s.stiffness_npm.value / k - 1.0,
          .false_viscous = s.viscous_nspm.value * s.velocity_rms_mps / fc,
          .curve = curve_error(s, c, visits),
          .coulomb_sigmas = (s.coulomb_n.value - fc) / s.coulomb_n.std,
          .stiffness_sigmas = (s.stiffness_npm.value - k) / s.stiffness_npm.std,
          .snapshot = s};
}

/// Root mean square error relative to the truth's, means removed on request.
class RelativeError {
 public:
  void add(double estimate, double truth) {
    const double e = estimate - truth;
    n_ += 1.0;
    e_ += e;
    ee_ += e * e;
    t_ += truth;
    tt_ += truth * truth;
  }
  [[nodiscard]] double with_mean() const { return std::sqrt(ee_ / tt_); }
  [[nodiscard]] double without_mean() const {
    return std::sqrt((ee_ - e_ * e_ / n_) / (tt_ - t_ * t_ / n_));
  }

 private:
  double n_{0.0}, e_{0.0}, ee_{0.0}, t_{0.0}, tt_{0.0};
};

/// Simulates one record of the longest length and identifies it, with a look at each length.
inline RunErrors run_case(const AccuracyCase& c, std::uint64_t seed,
                          const std::vector<double>& lengths_s, const EstimatorConfig& base = {}) {
  sim::SimulationConfig config = c.simulation;
  config.seed = seed;
  sim::Simulation simulation{config};
  EstimatorConfig identifier_config = base;
  identifier_config.moving_mass_kg = config.truck.moving_mass_kg;
  const auto identifier = std::make_unique<Estimator>(identifier_config);
  constexpr std::size_t kHistory = 4096;
  std::vector<sim::Truth> truth(kHistory);
  Visits visits;
  RelativeError velocity;
  RelativeError deflection;
  RunErrors out;
  std::int64_t tick = 0;
  for (const double length_s : lengths_s) {
    const auto end = static_cast<std::int64_t>(length_s * sim::kSampleRateHz);
    for (; tick < end; ++tick) {
      const sim::SimulatedSample s = simulation.next();
      truth[static_cast<std::size_t>(tick) % kHistory] = s.truth;
      visits.add(s.truth.velocity_mps);
      const UpdateResult r = identifier->update(sim::to_sample(s));
      if (!r.has_motion) continue;
      const auto& t = truth[static_cast<std::size_t>(r.motion.tick) % kHistory];
      velocity.add(r.motion.velocity_mps, t.velocity_mps);
      deflection.add(r.motion.deflection_m, t.deflection_m);
    }
    out.at.push_back(errors_of(identifier->snapshot(), c, visits));
  }
  out.velocity = velocity.with_mean();
  out.deflection = deflection.without_mean();
  return out;
}

}  // namespace dampline::bench
