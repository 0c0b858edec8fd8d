// SPDX-License-Identifier: MIT
// Whether the deviations that `explain` states of a rig hold: records of known laws, simulated here
// in other ways than the library's, each explained without a configuration; of every parameter how
// often the truth lies within two deviations, and the rms of its distance in deviations.
//   coverage_rigs [RECORDS [SYSTEM]]
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "app/diagnosis/rig/explain.hpp"
#include "app/record/columns.hpp"

namespace {

using namespace dampline;

constexpr double kRateHz = 400.0;
constexpr double kLengthS = 40.0;
constexpr int kFine = 10;  // steps a sample of laws with a memory

struct Motion {
  double x{0.0};
  double v{0.0};
};

/// Tones of random size, frequency and phase.
class Tones {
 public:
  explicit Tones(std::mt19937_64& random) {
    std::uniform_real_distribution<double> any{0.0, 1.0};
    for (int i = 0; i < 5; ++i)
      tones_.push_back({(0.004 + 0.004 * any(random)) / (1.0 + i),
                        (0.3 + 0.6 * i) * (1.0 + 0.4 * any(random)), 2.0 * M_PI * any(random)});
  }
  [[nodiscard]] Motion at(double t) const {
    Motion out;
    for (const auto& [amplitude, hz, phase] : tones_) {
      const double w = 2.0 * M_PI * hz;
      out.x += amplitude * std::sin(w * t + phase);
      out.v += amplitude * w * std::cos(w * t + phase);
    }
    return out;
  }

 private:
  struct Tone {
    double amplitude, hz, phase;
  };
  std::vector<Tone> tones_;
};

double sign(double v) { return v < 0.0 ? -1.0 : 1.0; }
double simple(const Motion& m) { return 300.0 * sign(m.v) + 900.0 * m.v; }

/// A force, told every fine step; with its own memory.
using Law = std::function<double(const Motion&, double step_m)>;

struct System {
  const char* name;
  std::function<Law()> make;
  std::map<std::string, double> truth;
  double late_s{0.0};
};

Law dahl(double travel_m) {
  return [travel_m, z = 0.0](const Motion& m, double step_m) mutable {
    z += step_m / travel_m * (1.0 - z * sign(m.v));
    return 300.0 * z + 900.0 * m.v;
  };
}

const std::vector<System>& systems() {
  static const std::vector<System> kSystems{
      {"friction",
       [] { return [](const Motion& m, double) { return simple(m); }; },
       {{"coulomb", 300.0}, {"viscous", 900.0}}},
      {"spring",
       [] { return [](const Motion& m, double) { return simple(m) + 9000.0 * m.x; }; },
       {{"coulomb", 300.0}, {"viscous", 900.0}, {"stiffness", 9000.0}}},
      {"smooth",
       [] {
         return
             [](const Motion& m, double) { return 300.0 * std::tanh(m.v / 0.006) + 900.0 * m.v; };
       },
       {{"coulomb", 300.0}, {"viscous", 900.0}, {"law_width", 0.006}}},
      {"offset",
       [] { return [](const Motion& m, double) { return simple(m) - 70.0; }; },
       {{"coulomb", 300.0}, {"viscous", 900.0}, {"offset", -70.0}}},
      {"asymmetric",
       [] {
         return
             [](const Motion& m, double) { return simple(m) + (m.v > 0.0 ? 2500.0 * m.v : 0.0); };
       },
       {{"coulomb", 300.0}, {"viscous_positive", 3400.0}, {"viscous_negative", 900.0}}},
      {"quadratic",
       [] { return [](const Motion& m, double) { return simple(m) + 6e4 * m.v * std::abs(m.v); }; },
       {{"coulomb", 300.0}, {"viscous", 900.0}, {"quadratic_damping", 6e4}}},
      {"stribeck",
       [] {
         return [](const Motion& m, double) {
           return simple(m) + sign(m.v) * 150.0 * std::exp(-std::abs(m.v) / 0.008);
         };
       },
       {{"coulomb", 300.0},
        {"viscous", 900.0},
        {"stribeck_force", 150.0},
        {"stribeck_speed", 0.008}}},
      {"cubic",
       [] {
         return [](const Motion& m, double) {
           return simple(m) + 9000.0 * m.x + 1.7e8 * m.x * m.x * m.x;
         };
       },
       {{"coulomb", 300.0}, {"viscous", 900.0}, {"stiffness", 9000.0}, {"cubic_stiffness", 1.7e8}}},
      {"bump",
       [] {
         return [](const Motion& m, double) {
           return simple(m) + 9000.0 * m.x +
                  1.5e5 * sign(m.x) * std::max(std::abs(m.x) - 0.005, 0.0);
         };
       },
       {{"coulomb", 300.0},
        {"stiffness", 9000.0},
        {"bump_stop_stiffness", 1.5e5},
        {"bump_stop_gap", 0.005}}},
      {"dahl",
       [] { return dahl(0.0011); },
       {{"viscous", 900.0},
        {"presliding_hysteresis_force", 300.0},
        {"presliding_hysteresis_travel", 0.0011}}},
      {"late",
       [] { return [](const Motion& m, double) { return simple(m); }; },
       {{"coulomb", 300.0}, {"viscous", 900.0}, {"time_skew", 4.1}},
       0.0041}};
  return kSystems;
}

std::string record_of(const System& system, std::uint64_t seed) {
  std::mt19937_64 random{seed};
  std::normal_distribution<double> noise;
  const Tones tones{random};
  const Law law = system.make();
  std::string text = "time_s,deflection_m,force_n\n";
  double last_m = tones.at(-1.0 - system.late_s).x;
  for (int i = -static_cast<int>(kRateHz) * kFine; i < static_cast<int>(kRateHz * kLengthS) * kFine;
       ++i) {
    const double t = i / (kRateHz * kFine);
    const Motion then = tones.at(t - system.late_s);
    const double force_n = law(then, then.x - last_m);
    last_m = then.x;
    if (i >= 0 && i % kFine == 0)
      text += fmt::format("{:.6f},{:.9f},{:.4f}\n", t, tones.at(t).x + 2e-7 * noise(random),
                          force_n + 5.0 * noise(random));
  }
  return text;
}

struct Tally {
  int count{0};
  int within{0};
  double sum{0.0};
  double squares{0.0};
  double relative{0.0};
};

void study(const System& system, int records) {
  std::map<std::string, Tally> tallies;
  std::map<std::string, int> names;
  const auto file = std::filesystem::temp_directory_path() /
                    fmt::format("coverage_{}_{}.csv", system.name, std::random_device{}());
  for (int seed = 1; seed <= records; ++seed) {
    std::ofstream{file} << record_of(system, static_cast<std::uint64_t>(seed) + 5000);
    const app::RecognisedColumns seen = app::recognise_columns({}, {file.string(), false});
    const app::rig::Explanation found =
        app::rig::explain(seen.config, {{file.string()}, {}, "", false});
    std::string name;
    for (const app::Step& s : found.steps) name += (name.empty() ? "" : "+") + s.effect;
    ++names[name.empty() ? found.verdict() : name];
    for (const app::Parameter& p : found.final.parameters) {
      const auto truth = system.truth.find(p.name);
      if (truth == system.truth.end() || !(p.std > 0.0)) continue;
      Tally& t = tallies[p.name];
      const double z = (p.value - truth->second) / p.std;
      ++t.count;
      t.within += static_cast<int>(std::abs(z) < 2.0);
      t.sum += z;
      t.squares += z * z;
      t.relative += p.std / std::abs(truth->second);
    }
  }
  std::filesystem::remove(file);
  for (const auto& [name, count] : names) fmt::print("{:<12} {} x {}\n", system.name, count, name);
  for (const auto& [name, t] : tallies)
    fmt::print(
        "{:<12} {:<30} {:>3} of {:>3} within two deviations, mean z {:6.2f}, rms z {:5.2f}, "
        "deviation {:.2g} %\n",
        system.name, name, t.within, t.count, t.sum / t.count, std::sqrt(t.squares / t.count),
        100.0 * t.relative / t.count);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int records = argc > 1 ? std::atoi(argv[1]) : 40;
  for (const System& system : systems())
    if (argc < 3 || std::string{argv[2]} == system.name) study(system, records);
  return 0;
}
