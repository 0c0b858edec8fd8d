// SPDX-License-Identifier: MIT
// How `explain` stands noise on the motion: a driven mass, 60 s, 60 tones of 0.3 to 12 Hz, white
// noise on the displacement (per cent of its rms), the force clean; at the end noise on the force
// instead. Integrated here, in fine steps with exact stick. The true base and the one true effect
// are given. Of every coefficient the error; of all, how often truth lies within two deviations.
//   noise [SEEDS [SYSTEM]]      the table as bench/RESULTS.md has it
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "app/diagnosis/rig/explain.hpp"
#include "app/record/columns.hpp"

namespace {

using namespace dampline;

constexpr double kLengthS = 60.0;
constexpr double kMassKg = 10.0;
constexpr double kStiffnessNpm = 3600.0;
constexpr double kViscous = 18.0;
constexpr int kFine = 24;  // steps a sample

struct State {
  double x{0.0};
  double v{0.0};
  double z{0.0};
};

/// What beside m x'' and the friction that can hold the mass.
struct System {
  const char* name;
  double rate_hz;
  double force_n;  ///< rms of the drive
  std::vector<std::string> base;
  std::vector<std::string> effects;
  std::map<std::string, double> truth;
  std::function<double(const State&)> law;
  std::function<double(double speed)> friction;  ///< empty: none
  double travel_m{0.0};                          ///< of Dahl's element
};

std::vector<System> systems() {
  const auto linear = [](const State& s) { return kStiffnessNpm * s.x + kViscous * s.v; };
  const std::map<std::string, double> plain{
      {"moving_mass", kMassKg}, {"stiffness", kStiffnessNpm}, {"viscous", kViscous}};
  auto with = [&](std::map<std::string, double> more) {
    more.insert(plain.begin(), plain.end());
    return more;
  };
  return {{"linear", 200.0, 60.0, {"viscous"}, {"none"}, plain, linear, {}},
          {"Duffing",
           500.0,
           60.0,
           {"viscous"},
           {"cubic_stiffness"},
           with({{"cubic_stiffness", 2e6}}),
           [=](const State& s) { return linear(s) + 2e6 * s.x * s.x * s.x; },
           {}},
          {"Coulomb",
           1000.0,
           60.0,
           {"coulomb", "viscous"},
           {"none"},
           with({{"coulomb", 25.0}}),
           linear,
           [](double) { return 25.0; }},
          {"Stribeck",
           1000.0,
           60.0,
           {"coulomb", "viscous"},
           {"stribeck"},
           with({{"coulomb", 15.0}, {"stribeck_force", 12.0}, {"stribeck_speed", 0.05}}),
           linear,
           [](double speed) { return 15.0 + 12.0 * std::exp(-speed / 0.05); }},
          {"Dahl",
           500.0,
           60.0,
           {"viscous"},
           {"presliding_hysteresis"},
           with({{"presliding_hysteresis_stiffness", 20.0 / 4e-3},
                 {"presliding_hysteresis_travel", 4e-3}}),
           [=](const State& s) { return linear(s) + 20.0 / 4e-3 * s.z; },
           {},
           4e-3}};
}

class Drive {
 public:
  Drive(std::mt19937_64& random, double rms_n) {
    std::uniform_real_distribution<double> any{0.0, 1.0};
    for (int i = 0; i < kTones; ++i)
      tones_.push_back({2.0 * std::numbers::pi * (0.3 + 11.7 * (i + any(random)) / kTones),
                        2.0 * std::numbers::pi * any(random)});
    size_n_ = rms_n / std::sqrt(0.5 * kTones);
  }
  [[nodiscard]] double operator()(double time_s) const {
    double out = 0.0;
    for (const auto& [w, phase] : tones_) out += std::cos(w * time_s + phase);
    return size_n_ * out;
  }

 private:
  static constexpr int kTones = 60;
  struct Tone {
    double w, phase;
  };
  std::vector<Tone> tones_;
  double size_n_;
};

struct Record {
  std::vector<double> x, force_n;
};

/// Runge and Kutta's fourth order; a step in which the velocity passes zero ends there, and the
/// mass stays while the friction holds it.
Record simulate(const System& system, const Drive& drive) {
  const double h = 1.0 / (system.rate_hz * kFine);
  State s;
  int side = 0;
  const auto accel = [&](double t, const State& at) {
    const double held = system.friction ? side * system.friction(std::max(0.0, side * at.v)) : 0.0;
    return (drive(t) - system.law(at) - held) / kMassKg;
  };
  const auto z_rate = [&](const State& at) {
    return system.travel_m > 0.0 ? at.v - std::abs(at.v) * at.z / system.travel_m : 0.0;
  };
  const auto moved = [&](const State& from, double t, double step) {
    const auto rate = [&](double at_s, const State& at) {
      return State{at.v, accel(at_s, at), z_rate(at)};
    };
    const auto plus = [&](const State& by, double dt) {
      return State{from.x + dt * by.x, from.v + dt * by.v, from.z + dt * by.z};
    };
    const State a = rate(t, from);
    const State b = rate(t + 0.5 * step, plus(a, 0.5 * step));
    const State c = rate(t + 0.5 * step, plus(b, 0.5 * step));
    const State d = rate(t + step, plus(c, step));
    return plus({(a.x + 2 * (b.x + c.x) + d.x) / 6, (a.v + 2 * (b.v + c.v) + d.v) / 6,
                 (a.z + 2 * (b.z + c.z) + d.z) / 6},
                step);
  };
  Record out;
  const auto samples = static_cast<int>(kLengthS * system.rate_hz);
  for (int i = 0; i < samples * kFine; ++i) {
    const double t = i * h;
    if (i % kFine == 0) {
      out.x.push_back(s.x);
      out.force_n.push_back(drive(t));
    }
    if (!system.friction) {
      s = moved(s, t, h);
      continue;
    }
    if (s.v == 0.0) {
      const double pull = drive(t) - system.law(s);
      if (std::abs(pull) <= system.friction(0.0)) continue;
      side = pull > 0.0 ? 1 : -1;
    }
    const State next = moved(s, t, h);
    if (next.v * side < 0.0) {
      double low = 0.0;
      double high = h;
      for (int k = 0; k < 50; ++k) {
        const double middle = 0.5 * (low + high);
        (moved(s, t, middle).v * side < 0.0 ? high : low) = middle;
      }
      s = moved(s, t, low);
      s.v = 0.0;
      const double pull = drive(t + low) - system.law(s);
      if (std::abs(pull) > system.friction(0.0)) {
        side = pull > 0.0 ? 1 : -1;
        s = moved(s, t + low, h - low);
      }
    } else {
      s = next;
    }
  }
  return out;
}

double rms(const std::vector<double>& values) {
  double out = 0.0;
  for (const double v : values) out += v * v;
  return std::sqrt(out / static_cast<double>(values.size()));
}

struct Told {
  app::rig::Explanation explanation;
  double time_s{0.0};
};

Told explained(const System& system, unsigned seed, double noise_of_x, double noise_of_force) {
  std::mt19937_64 random{seed};
  const Drive drive{random, system.force_n};
  const Record record = simulate(system, drive);
  const double of_x = noise_of_x * rms(record.x);
  const double of_force = noise_of_force * rms(record.force_n);
  std::normal_distribution<double> noise;
  std::string text = "time_s,deflection_m,force_n\n";
  for (std::size_t i = 0; i < record.x.size(); ++i)
    text += fmt::format("{:.6f},{:.12g},{:.12g}\n", static_cast<double>(i) / system.rate_hz,
                        record.x[i] + of_x * noise(random),
                        record.force_n[i] + of_force * noise(random));
  const std::string path =
      (std::filesystem::temp_directory_path() / fmt::format("noise_{}_{}.csv", system.name, seed))
          .string();
  std::ofstream{path} << text;
  app::Config config;
  config.model.base = system.base;
  config.model.candidates = system.effects;
  config.model.inertia = "identify";
  config.model.stiffness = "identify";
  const auto start = std::chrono::steady_clock::now();
  Told out{app::rig::explain(config, {{path}, {}, "", false})};
  out.time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::filesystem::remove(path);
  return out;
}

double median(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void look(const System& system, unsigned seeds, double of_x, double of_force) {
  std::map<std::string, std::vector<double>> errors;
  std::vector<double> worst;
  std::vector<double> times_s;
  int within = 0;
  int told = 0;
  int by_motion = 0;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const Told told_of = explained(system, seed, of_x, of_force);
    const app::rig::Explanation& found = told_of.explanation;
    times_s.push_back(told_of.time_s);
    double most = 0.0;
    by_motion += found.final.free_run.by_motion ? 1 : 0;
    for (const auto& [name, truth] : system.truth) {
      const auto p =
          std::find_if(found.final.parameters.begin(), found.final.parameters.end(),
                       [&, key = name](const app::Parameter& each) { return each.name == key; });
      if (p == found.final.parameters.end()) {
        errors[name].push_back(std::numeric_limits<double>::infinity());
        most = std::numeric_limits<double>::infinity();
        continue;
      }
      const double error = 100.0 * std::abs(p->value / truth - 1.0);
      errors[name].push_back(error);
      most = std::max(most, error);
      within += std::abs(p->value - truth) <= 2.0 * p->std ? 1 : 0;
      ++told;
    }
    worst.push_back(most);
  }
  fmt::print("| {} | {:g} | {:g} | {:.3g} |", system.name, 100.0 * of_x, 100.0 * of_force,
             median(worst));
  for (const auto& [name, list] : errors) fmt::print(" {} {:.2g};", name, median(list));
  fmt::print(" | {} of {} | {} of {} | {:.1f} |\n", within, told, by_motion, seeds,
             median(times_s));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const unsigned seeds = argc > 1 ? static_cast<unsigned>(std::atoi(argv[1])) : 5;
  const std::string only = argc > 2 ? argv[2] : "";
  fmt::print(
      "| system | noise of x, % | of the force, % | worst error, % | each, median % | within two "
      "deviations | by its motion | s a record |\n|---|---|---|---|---|---|---|---|\n");
  for (const System& system : systems()) {
    if (!only.empty() && only != system.name) continue;
    for (const double noise : {0.0, 0.001, 0.01, 0.05}) look(system, seeds, noise, 0.0);
    look(system, seeds, 0.0, 0.05);
  }
  return 0;
}
