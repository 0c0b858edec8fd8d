// SPDX-License-Identifier: MIT
// How `explain` stands noise on the motion: a driven mass, 60 s, 60 tones of 0.3 to 12 Hz, white
// noise on the displacement (per cent of its rms), the force clean; at the end noise on both, and
// on the force instead. Integrated here, in fine steps with exact stick. The true base and the one
// true effect are given. Of every coefficient the error; of all, how often truth lies within two
// deviations.
//   noise [SEEDS [SYSTEM [NOISE]]]              the table as bench/RESULTS.md has it
//   noise --free [SEEDS [SYSTEM [NOISE]]]       what explain names when nothing is given
//   noise --records FOLDER [SEEDS [SYSTEM [NOISE]]]   the records, for bench/peers/noise.py
// SYSTEM may be all; NOISE: of the displacement, or of both as 1/1.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
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

/// What acts beside m x'', and the friction that can hold the mass.
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
          {"VanDerPol",
           500.0,
           60.0,
           {"viscous", "progressive_damping"},
           {"none"},
           {{"moving_mass", kMassKg},
            {"stiffness", kStiffnessNpm},
            {"viscous", -30.0},
            {"progressive_damping", 3e5}},
           [](const State& s) { return kStiffnessNpm * s.x + (3e5 * s.x * s.x - 30.0) * s.v; },
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
  /// At `count` instants `step_s` apart, each tone turned on from one to the next.
  [[nodiscard]] std::vector<double> grid(std::size_t count, double step_s) const {
    constexpr std::size_t kAnew = 1024;
    std::vector<double> out(count, 0.0);
    for (const auto& [w, phase] : tones_) {
      const std::complex<double> turn = std::polar(1.0, w * step_s);
      std::complex<double> at;
      for (std::size_t i = 0; i < count; ++i) {
        at = i % kAnew == 0 ? std::polar(size_n_, w * static_cast<double>(i) * step_s + phase)
                            : at * turn;
        out[i] += at.real();
      }
    }
    return out;
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

/// Until when it is so, of [0, most_s]; at first it is, at the end not.
double last_of(const auto& is_so, double most_s) {
  double low = 0.0;
  double high = most_s;
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (low + high);
    (is_so(middle) ? low : high) = middle;
  }
  return low;
}

/// Runge and Kutta's fourth order; a step in which the velocity passes zero ends there, and the
/// mass stays while the friction holds it.
Record simulate(const System& system, const Drive& drive) {
  const double h = 1.0 / (system.rate_hz * kFine);
  State s;
  int side = 0;
  const auto samples = static_cast<std::size_t>(kLengthS * system.rate_hz);
  const std::vector<double> force_n = drive.grid(2 * kFine * samples + 3, 0.5 * h);
  const auto force_at = [&](double t) {
    const double place = t / (0.5 * h);
    const auto i = static_cast<std::size_t>(std::lround(place));
    return std::abs(place - static_cast<double>(i)) < 1e-6 ? force_n[i] : drive(t);
  };
  const auto accel = [&](double t, const State& at) {
    const double held = system.friction ? side * system.friction(std::max(0.0, side * at.v)) : 0.0;
    return (force_at(t) - system.law(at) - held) / kMassKg;
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
  for (std::size_t i = 0; i < samples * kFine; ++i) {
    const double t = static_cast<double>(i) * h;
    if (i % kFine == 0) {
      out.x.push_back(s.x);
      out.force_n.push_back(force_at(t));
    }
    if (!system.friction) {
      s = moved(s, t, h);
      continue;
    }
    double held_s = 0.0;  // of this step
    if (s.v == 0.0) {
      const auto pull = [&](double after) { return force_at(t + after) - system.law(s); };
      const auto holds = [&](double after) {
        return std::abs(pull(after)) <= system.friction(0.0);
      };
      if (holds(0.0) && holds(h)) continue;
      if (holds(0.0)) held_s = last_of(holds, h);
      side = pull(held_s) > 0.0 ? 1 : -1;
    }
    const double from_s = t + held_s;
    const double left_s = h - held_s;
    const State next = moved(s, from_s, left_s);
    if (next.v * side < 0.0) {
      const double low =
          last_of([&](double after) { return moved(s, from_s, after).v * side >= 0.0; }, left_s);
      s = moved(s, from_s, low);
      s.v = 0.0;
      const double pull = drive(from_s + low) - system.law(s);
      if (std::abs(pull) > system.friction(0.0)) {
        side = pull > 0.0 ? 1 : -1;
        s = moved(s, from_s + low, left_s - low);
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

struct Noise {
  double of_x{0.0};
  double of_force{0.0};
};

std::string csv_of(const System& system, unsigned seed, const Noise& noise) {
  std::mt19937_64 random{seed};
  const Drive drive{random, system.force_n};
  const Record record = simulate(system, drive);
  const double of_x = noise.of_x * rms(record.x);
  const double of_force = noise.of_force * rms(record.force_n);
  std::normal_distribution<double> normal;
  std::string out = "time_s,deflection_m,force_n\n";
  for (std::size_t i = 0; i < record.x.size(); ++i)
    out += fmt::format("{:.6f},{:.12g},{:.12g}\n", static_cast<double>(i) / system.rate_hz,
                       record.x[i] + of_x * normal(random),
                       record.force_n[i] + of_force * normal(random));
  return out;
}

struct Told {
  app::rig::Explanation explanation;
  double time_s{0.0};  ///< of the processor
};

/// `free`: nothing but the mass and the spring is given.
Told explained(const System& system, unsigned seed, const Noise& noise, bool free) {
  const std::filesystem::path path = std::filesystem::temp_directory_path() /
                                     fmt::format("noise_{}_{}.csv", system.name, ::getpid());
  std::ofstream{path} << csv_of(system, seed, noise);
  app::Config config;
  if (!free) {
    config.model.base = system.base;
    config.model.candidates = system.effects;
  }
  config.model.inertia = "identify";
  config.model.stiffness = "identify";
  const std::clock_t start = std::clock();
  Told out{app::rig::explain(config, {{path.string()}, {}, "", false})};
  out.time_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  std::filesystem::remove(path);
  return out;
}

double median(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Errors of all seeds, per cent of the truth.
struct Errors {
  std::map<std::string, std::vector<double>> each;
  std::vector<double> worst;
  int within{0};
  int told{0};

  void take(const System& system, const std::vector<app::Parameter>& found) {
    double most = 0.0;
    for (const auto& [name, truth] : system.truth) {
      const auto p = std::find_if(found.begin(), found.end(),
                                  [&, key = name](const auto& other) { return other.name == key; });
      const double error = p == found.end() ? std::numeric_limits<double>::infinity()
                                            : 100.0 * std::abs(p->value / truth - 1.0);
      each[name].push_back(error);
      most = std::max(most, error);
      if (p == found.end()) continue;
      within += std::abs(p->value - truth) <= 2.0 * p->std ? 1 : 0;
      ++told;
    }
    worst.push_back(most);
  }
};

void look(const System& system, unsigned seeds, const Noise& noise) {
  Errors errors;
  std::vector<double> times_s;
  int by_motion = 0;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const Told told = explained(system, seed, noise, false);
    times_s.push_back(told.time_s);
    by_motion += told.explanation.final.free_run.by_motion ? 1 : 0;
    errors.take(system, told.explanation.final.parameters);
  }
  fmt::print("| {} | {:g} | {:g} | {:.3g} |", system.name, 100.0 * noise.of_x,
             100.0 * noise.of_force, median(errors.worst));
  for (const auto& [name, list] : errors.each) fmt::print(" {} {:.2g};", name, median(list));
  fmt::print(" | {} of {} | {} of {} | {:.1f} |\n", errors.within, errors.told, by_motion, seeds,
             median(times_s));
  std::fflush(stdout);
}

/// What `explain` names when nobody tells it anything.
void look_freely(const System& system, unsigned seeds, const Noise& noise) {
  std::map<std::string, int> answers;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const app::rig::Explanation found = explained(system, seed, noise, true).explanation;
    std::string answer = fmt::format("{}: {}", found.verdict(), fmt::join(found.base.terms, ", "));
    for (const app::Step& step : found.steps) answer += " + " + step.effect;
    ++answers[answer];
  }
  fmt::print("| {} | {:g} | {:g} |", system.name, 100.0 * noise.of_x, 100.0 * noise.of_force);
  for (const auto& [answer, count] : answers) fmt::print(" {} x {};", count, answer);
  fmt::print(" |\n");
  std::fflush(stdout);
}

/// The records of the table for another program: SYSTEM_NOISE_FORCE_SEED.csv and the truth.
void write_records(const System& system, unsigned seeds, const Noise& noise,
                   const std::filesystem::path& folder) {
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const std::string name = fmt::format("{}_{:g}_{:g}_{}", system.name, 100.0 * noise.of_x,
                                         100.0 * noise.of_force, seed);
    std::ofstream file{folder / (name + ".csv")};
    for (const auto& [parameter, truth] : system.truth)
      file << fmt::format("# {} {:.17g}\n", parameter, truth);
    file << csv_of(system, seed, noise);
  }
}

constexpr std::array kNoises{Noise{0.0, 0.0},  Noise{0.001, 0.0}, Noise{0.01, 0.0},
                             Noise{0.05, 0.0}, Noise{0.01, 0.01}, Noise{0.0, 0.05}};

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words{argv + 1, argv + argc};
  const bool writes = !words.empty() && words[0] == "--records";
  const bool freely = !words.empty() && words[0] == "--free";
  const std::size_t first = writes ? 2 : freely ? 1 : 0;
  const auto word = [&](std::size_t i, const char* otherwise) {
    return words.size() > first + i ? words[first + i] : std::string{otherwise};
  };
  const auto seeds = static_cast<unsigned>(std::stoul(word(0, "5")));
  const std::string only = word(1, "all");
  const std::string level = word(2, "");
  if (writes) std::filesystem::create_directories(words.at(1));
  if (freely)
    fmt::print(
        "| system | noise of x, % | of the force, % | what a free explain says |\n"
        "|---|---|---|---|\n");
  else if (!writes)
    fmt::print(
        "| system | noise of x, % | of the force, % | worst error, % | each, median % | within two "
        "deviations | by its motion | processor s a record |\n|---|---|---|---|---|---|---|---|\n");
  for (const System& system : systems())
    for (const Noise& noise : kNoises) {
      if (only != "all" && only != system.name) continue;
      const std::string of_x = fmt::format("{:g}", 100.0 * noise.of_x);
      const std::string of_both = fmt::format("{}/{:g}", of_x, 100.0 * noise.of_force);
      if (!level.empty() && level != of_x && level != of_both) continue;
      if (writes)
        write_records(system, seeds, noise, words.at(1));
      else if (!freely)
        look(system, seeds, noise);
      else
        look_freely(system, seeds, noise);
    }
  return 0;
}
