// SPDX-License-Identifier: MIT
// Which recursive estimators survive a day of running and hours of standing still, with forgetting.
// `peers_robust [--hours H] [--json FILE]`; two minutes for the 24 h. See bench/README.md.
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "bench/peers/estimators.hpp"

namespace dampline::bench {
namespace {

constexpr int kUnknowns = 8;
constexpr double kRateHz = 300.0;
constexpr double kForgetting = 0.9995;
constexpr double kDriveS = 300.0;  // before and after a standstill

struct Outcome {
  double nan_after_s{-1.0};  // of the run; negative: never
  double error_before{0.0};  // largest of the parameters, whose size is up to 1
  double error_after{0.0};
};

template <class Estimator>
class Run {
 public:
  Run() : estimator_{kForgetting} {}

  void drive(double seconds) {
    Column<kUnknowns> x;
    double y = 0.0;
    for (std::int64_t i = 0; i < samples(seconds); ++i) {
      rows_.next(x, y);
      take(x, y);
    }
  }
  /// No motion: regressors of nothing but zeros, as sensors of 12 bit give them.
  void stand(double seconds) {
    const Column<kUnknowns> x = Column<kUnknowns>::Zero();
    for (std::int64_t i = 0; i < samples(seconds); ++i) take(x, 0.0);
  }
  [[nodiscard]] double error() const {
    const Column<kUnknowns> off = estimator_.answer() - true_parameters<kUnknowns>();
    return off.allFinite() ? off.cwiseAbs().maxCoeff() : std::nan("");
  }
  [[nodiscard]] double nan_after_s() const noexcept { return nan_after_s_; }

 private:
  static std::int64_t samples(double seconds) { return std::llround(seconds * kRateHz); }
  void take(const Column<kUnknowns>& x, double y) {
    estimator_.absorb(x, y);
    ++taken_;
    if (taken_ % 300 != 0 || nan_after_s_ >= 0.0) return;
    if (!estimator_.answer().allFinite()) nan_after_s_ = static_cast<double>(taken_) / kRateHz;
  }

  Estimator estimator_;
  WhiteRows<kUnknowns> rows_{1};
  std::int64_t taken_{0};
  double nan_after_s_{-1.0};
};

template <class Estimator>
Outcome day(double hours) {
  Run<Estimator> run;
  run.drive(kDriveS);
  Outcome out{.error_before = run.error()};
  run.drive(3600.0 * hours - kDriveS);
  out.error_after = run.error();
  out.nan_after_s = run.nan_after_s();
  return out;
}

template <class Estimator>
Outcome standstill(double seconds) {
  Run<Estimator> run;
  run.drive(kDriveS);
  Outcome out{.error_before = run.error()};
  run.stand(seconds);
  run.drive(kDriveS);
  out.error_after = run.error();
  out.nan_after_s = run.nan_after_s();
  return out;
}

std::string text(const Outcome& o) {
  if (o.nan_after_s < 0.0) return fmt::format("{:.1e}", o.error_after);
  return fmt::format("{}, not a number after {:.0f} s",
                     std::isnan(o.error_after) ? "lost" : fmt::format("{:.1e}", o.error_after),
                     o.nan_after_s);
}

nlohmann::json json_of(const Outcome& o) {
  nlohmann::json out{{"error_before", o.error_before}, {"error_after", nullptr}};
  if (!std::isnan(o.error_after)) out["error_after"] = o.error_after;
  if (o.nan_after_s >= 0.0) out["not_a_number_after_s"] = o.nan_after_s;
  return out;
}

template <class Estimator>
void compete(const char* name, double hours, nlohmann::json& out) {
  const Outcome running = day<Estimator>(hours);
  const Outcome quarter = standstill<Estimator>(900.0);
  const Outcome shift = standstill<Estimator>(8.0 * 3600.0);
  fmt::print("| {} | {:.1e} | {} | {} | {} |\n", name, running.error_before, text(running),
             text(quarter), text(shift));
  std::fflush(stdout);
  out["robustness"].push_back({{"name", name},
                               {"hours", hours},
                               {"running", json_of(running)},
                               {"standstill_900_s", json_of(quarter)},
                               {"standstill_28800_s", json_of(shift)}});
}

int run(int argc, char** argv) {
  double hours = 24.0;
  std::string path;
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::string_view{argv[i]} == "--hours") hours = std::atof(argv[i + 1]);
    if (std::string_view{argv[i]} == "--json") path = argv[i + 1];
  }
  nlohmann::json out;
  fmt::print(
      "{} unknowns at 300 Hz, forgetting {}: largest error of a parameter\n\n"
      "| estimator | after 5 min | after {:.1f} h of running | 5 min after 15 min of "
      "standstill | 5 min after 8 h of standstill |\n|--|--|--|--|--|\n",
      kUnknowns, kForgetting, hours);
  compete<OursGated<kUnknowns>>("dampline, standstill left out as the Identifier does", hours, out);
  compete<Ours<kUnknowns>>("dampline, given every row", hours, out);
  compete<EigenCovariance<kUnknowns>>("Eigen, covariance recursion", hours, out);
  compete<EigenSymmetric<kUnknowns>>("Eigen, one triangle of the covariance", hours, out);
#ifdef DAMPLINE_HAS_DLIB
  compete<Dlib<kUnknowns>>("dlib::rls", hours, out);
  compete<DlibForgetful<kUnknowns>>("dlib::rls, forgetting its prior too", hours, out);
#endif
#ifdef DAMPLINE_HAS_ARMADILLO
  compete<Armadillo<kUnknowns>>("Armadillo, covariance recursion", hours, out);
#endif
#ifdef DAMPLINE_HAS_LIQUID
  compete<Liquid<kUnknowns>>("liquid eqrls_rrrf", hours, out);
#endif
  std::fputs(missing_peers(), stdout);
  if (!path.empty()) std::ofstream{path} << out.dump(2) << '\n';
  return 0;
}

}  // namespace
}  // namespace dampline::bench

int main(int argc, char** argv) { return dampline::bench::run(argc, argv); }
