// SPDX-License-Identifier: MIT
// Motion beside another library's filter, densities beside another library's histograms, on the
// same samples. `peers_signals [--json FILE] [--signals FILE]`: --signals writes the samples and
// the counts for signals.py; see bench/README.md.
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>

#include "bench/peers/estimators.hpp"
#include "bench/peers/rows.hpp"
#include "bench/ride.hpp"
#include "dampline/density/histogram.hpp"
#include "dampline/density/joint_histogram.hpp"
#ifdef DAMPLINE_HAS_GSL
#include <gsl/gsl_histogram.h>
#include <gsl/gsl_histogram2d.h>
#endif

namespace dampline::bench {
namespace {

constexpr int kRounds = 15;
constexpr double kLargestDeflectionM = 2e-3;
constexpr double kLargestVelocityMps = 0.05;

/// Takes a value where the compiler cannot see what becomes of it.
volatile double sink = 0.0;

/// The relative acceleration of the ride, and its motion.
struct Signals {
  std::vector<double> relative_mps2;
  std::vector<double> deflection_m;
  std::vector<double> velocity_mps;
  Signals() {
    for (const Heard& heard : heard()) {
      const auto& a = heard.sample.accel_mps2;
      relative_mps2.push_back(2.0 * a[0] - a[1] - a[2]);
      deflection_m.push_back(heard.result.motion.deflection_m);
      velocity_mps.push_back(heard.result.motion.velocity_mps);
    }
  }
};

struct Counted {
  std::vector<double> line;
  std::vector<double> plane;
};

/// Filters are designed before the time begins.
void enter_motion(std::vector<Contestant>& list, const Signals& signals) {
  const Fir<VelocityLift::kHalf> new_lift{VelocityLift{{}, 300.0}.taps()};
  const DriftFreeIntegral new_integral{300.0};
  list.push_back({"motion: dampline, velocity and deflection (per output)", [=, &signals] {
                    auto lift = new_lift;
                    auto velocity = new_integral;
                    auto deflection = new_integral;
                    double a = 0.0;
                    double v = 0.0;
                    double y = 0.0;
                    for (const double x : signals.relative_mps2)
                      if (lift.update(x, a) && velocity.update(a, v) && deflection.update(v, y))
                        sink = y;
                  }});
  list.push_back({"motion: dampline, one integral", [=, &signals] {
                    auto velocity = new_integral;
                    double v = 0.0;
                    for (const double x : signals.relative_mps2)
                      if (velocity.update(x, v)) sink = v;
                  }});
#ifdef DAMPLINE_HAS_LIQUID
  const std::shared_ptr<iirfilt_rrrf_s> filter{
      iirfilt_rrrf_create_prototype(LIQUID_IIRDES_BUTTER, LIQUID_IIRDES_HIGHPASS, LIQUID_IIRDES_SOS,
                                    4, 0.7F / 300.0F, 0.0F, 1.0F, 60.0F),
      iirfilt_rrrf_destroy};
  list.push_back({"motion: liquid iirfilt_rrrf, fourth order", [filter, &signals] {
                    iirfilt_rrrf_reset(filter.get());
                    float out = 0.0F;
                    for (const double x : signals.relative_mps2) {
                      iirfilt_rrrf_execute(filter.get(), static_cast<float>(x), &out);
                      sink = static_cast<double>(out);
                    }
                  }});
#endif
}

void enter_ours(std::vector<Contestant>& list, const Signals& signals, Counted& counted) {
  list.push_back({"histogram of 64: dampline", [&] {
                    Histogram<64> histogram{
                        {.range = {.low = -kLargestVelocityMps, .high = kLargestVelocityMps}}};
                    for (const double v : signals.velocity_mps) histogram.update(v);
                    counted.line.clear();
                    for (std::size_t b = 0; b < 64; ++b) counted.line.push_back(histogram.mass(b));
                  }});
  list.push_back({"joint histogram of 32 x 32: dampline", [&] {
                    JointHistogram<32, 32> histogram{
                        {.x = {.low = -kLargestDeflectionM, .high = kLargestDeflectionM},
                         .y = {.low = -kLargestVelocityMps, .high = kLargestVelocityMps}}};
                    for (std::size_t i = 0; i < signals.velocity_mps.size(); ++i)
                      histogram.update(signals.deflection_m[i], signals.velocity_mps[i]);
                    counted.plane.clear();
                    for (std::size_t i = 0; i < 32; ++i)
                      for (std::size_t j = 0; j < 32; ++j)
                        counted.plane.push_back(histogram.share(i, j) *
                                                static_cast<double>(histogram.samples()));
                  }});
}

#ifdef DAMPLINE_HAS_GSL
void enter_gsl(std::vector<Contestant>& list, const Signals& signals, Counted& counted) {
  list.push_back({"histogram of 64: gsl_histogram_increment", [&] {
                    gsl_histogram* histogram = gsl_histogram_alloc(64);
                    gsl_histogram_set_ranges_uniform(histogram, -kLargestVelocityMps,
                                                     kLargestVelocityMps);
                    for (const double v : signals.velocity_mps)
                      gsl_histogram_increment(histogram, v);
                    counted.line.assign(histogram->bin, histogram->bin + 64);
                    gsl_histogram_free(histogram);
                  }});
  list.push_back(
      {"joint histogram of 32 x 32: gsl_histogram2d_increment", [&] {
         gsl_histogram2d* histogram = gsl_histogram2d_alloc(32, 32);
         gsl_histogram2d_set_ranges_uniform(histogram, -kLargestDeflectionM, kLargestDeflectionM,
                                            -kLargestVelocityMps, kLargestVelocityMps);
         for (std::size_t i = 0; i < signals.velocity_mps.size(); ++i)
           gsl_histogram2d_increment(histogram, signals.deflection_m[i], signals.velocity_mps[i]);
         counted.plane.assign(histogram->bin, histogram->bin + std::size_t{32} * 32);
         gsl_histogram2d_free(histogram);
       }});
}
#endif

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double out = a.size() == b.size() ? 0.0 : std::nan("");
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i)
    out = std::fmax(out, std::abs(a[i] - b[i]));
  return out;
}

/// Accelerations, deflections, velocities, and the project's counts of 64 and 32 x 32 bins.
void write_signals(const Signals& signals, const Counted& ours, const char* path) {
  std::ofstream file{path, std::ios::binary};
  for (const auto* numbers : {&signals.relative_mps2, &signals.deflection_m, &signals.velocity_mps,
                              &ours.line, &ours.plane})
    file.write(reinterpret_cast<const char*>(numbers->data()),
               static_cast<std::streamsize>(numbers->size() * sizeof(double)));
}

int run(int argc, char** argv) {
  const Signals signals;
  Counted ours;
  std::vector<Contestant> list;
  enter_motion(list, signals);
  enter_ours(list, signals, ours);
  Counted theirs;
#ifdef DAMPLINE_HAS_GSL
  enter_gsl(list, signals, theirs);
#endif
  race(list, kRounds);
  nlohmann::json out;
  fmt::print("| streaming, ns per sample | |\n|--|--|\n");
  for (const Contestant& c : list) {
    const double outputs = c.name.ends_with("(per output)") ? 2.0 : 1.0;
    const double ns = c.best_ns / outputs / static_cast<double>(signals.relative_mps2.size());
    fmt::print("| {} | {:.1f} |\n", c.name, ns);
    out["streaming"].push_back({{"name", c.name}, {"ns_per_sample", ns}});
  }
  bool same = true;
  if (!theirs.line.empty()) {
    const double line = largest_difference(ours.line, theirs.line);
    const double plane = largest_difference(ours.plane, theirs.plane);
    same = line < 0.5 && plane < 0.5;
    fmt::print("\nCounts of the bins differ by at most {:.3g} and {:.3g}: {}\n", line, plane,
               same ? "the same" : "NOT THE SAME");
    out["histograms_agree"] = same;
  }
  std::fputs(missing_peers(), stdout);
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string_view option = argv[i];
    if (option == "--json") std::ofstream{argv[i + 1]} << out.dump(2) << '\n';
    if (option == "--signals") write_signals(signals, ours, argv[i + 1]);
  }
  return same ? 0 : 1;
}

}  // namespace
}  // namespace dampline::bench

int main(int argc, char** argv) { return dampline::bench::run(argc, argv); }
