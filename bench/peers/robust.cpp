// SPDX-License-Identifier: MIT
// Which recursive estimators survive a day of running and hours of standing still, with forgetting;
// and the whole chain on a simulated car. Nothing is timed, so every core is used.
// `peers_robust [--hours H] [--json FILE]`; three minutes for the 24 h. See bench/README.md.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "bench/peers/estimators.hpp"
#include "dampline/damping/estimator.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::bench {

/// Of an estimator on a long run.
struct Outcome {
  double nan_after_s{-1.0};  ///< of the run, the first look without a number; negative: never
  double error_before{0.0};  ///< after the first five minutes
  double error_after{0.0};   ///< at the end
};

}  // namespace dampline::bench

namespace dampline::bench {

/// A simulated laden car through Identifiers of every kind of memory: the larger of the relative
/// errors of friction and stiffness.
class WholeChain {
 public:
  static constexpr std::size_t kMemories = 3;
  static constexpr std::array<const char*, kMemories> kNames{
      "dampline, Estimator, all of the record", "dampline, Estimator, window of 300 s",
      "dampline, Estimator, forgetting, 300 s"};
  using Outcomes = std::array<Outcome, kMemories>;

  /// Good excitation, with a look after `first_s`.
  static Outcomes day(double first_s, double seconds) {
    WholeChain chain{sim::reference_run(sim::Load::kLaden, 80.0, 1)};
    Outcomes out;
    chain.run(first_s);
    chain.look([&](std::size_t m, double error) { out[m].error_before = error; });
    chain.run(seconds - first_s);
    chain.conclude(out);
    return out;
  }

  /// `drive_s` of motion, the standstill, and as much motion again.
  static Outcomes standstill(double drive_s, double seconds) {
    sim::SimulationConfig config = sim::reference_run(sim::Load::kLaden, 80.0, 1);
    const double braking_s = config.speed.speed_mps / config.speed.ramp_mps2;
    const double stop_s = drive_s + braking_s;
    config.speed.standstills[0] = {stop_s, stop_s + seconds};
    WholeChain chain{config};
    Outcomes out;
    chain.run(drive_s);
    chain.look([&](std::size_t m, double error) { out[m].error_before = error; });
    chain.run(2.0 * braking_s + seconds + drive_s);
    chain.conclude(out);
    return out;
  }

 private:
  static constexpr double kLookEveryS = 60.0;

  explicit WholeChain(const sim::SimulationConfig& config) : truck_{config.truck}, sim_{config} {
    for (std::size_t m = 0; m < kMemories; ++m) {
      EstimatorConfig identifier;
      identifier.moving_mass_kg = truck_.moving_mass_kg;
      identifier.memory = static_cast<Memory>(m);
      identifier.memory_s = identifier.memory == Memory::kInfinite ? 0.0 : 300.0;
      identifiers_[m] = std::make_unique<Estimator>(identifier);
    }
  }

  void run(double seconds) {
    const auto samples = std::llround(seconds * sim::kSampleRateHz);
    for (std::int64_t i = 0; i < samples; ++i) {
      const Sample sample = sim::to_sample(sim_.next());
      for (const auto& identifier : identifiers_) static_cast<void>(identifier->update(sample));
      if (++taken_ % std::llround(kLookEveryS * sim::kSampleRateHz) != 0) continue;
      look([&](std::size_t m, double error) {
        known_[m] = known_[m] || std::isfinite(error);
        if (nan_after_s_[m] < 0.0 && known_[m] && !std::isfinite(error))
          nan_after_s_[m] = static_cast<double>(taken_) / sim::kSampleRateHz;
      });
    }
  }

  template <class Take>
  void look(Take take) {
    for (std::size_t m = 0; m < kMemories; ++m) take(m, error_of(identifiers_[m]->snapshot()));
  }

  void conclude(Outcomes& out) {
    look([&](std::size_t m, double error) {
      out[m].error_after = error;
      out[m].nan_after_s = nan_after_s_[m];
    });
  }

  [[nodiscard]] double error_of(const Snapshot& s) const {
    if (!s.valid) return std::nan("");
    const double coulomb_n =
        0.5 * truck_.friction_scale * (truck_.friction_positive_n + truck_.friction_negative_n);
    return std::fmax(std::abs(s.coulomb_n.value / coulomb_n - 1.0),
                     std::abs(s.stiffness_npm.value / truck_.stiffness_npm - 1.0));
  }

  sim::TruckConfig truck_;
  sim::Simulation sim_;
  std::array<std::unique_ptr<Estimator>, kMemories> identifiers_;
  std::array<bool, kMemories> known_{};  // there was an estimate before
  std::array<double, kMemories> nan_after_s_{-1.0, -1.0, -1.0};
  std::int64_t taken_{0};
};

}  // namespace dampline::bench

namespace dampline::bench {
namespace {

constexpr int kUnknowns = 8;
constexpr double kRateHz = 300.0;
constexpr double kForgetting = 0.9995;
constexpr double kDriveS = 300.0;  // before and after a standstill

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

struct Row {
  std::string name;
  Outcome running{};
  Outcome quarter{};
  Outcome shift{};
};

constexpr double kQuarterS = 900.0;
constexpr double kShiftS = 8.0 * 3600.0;

/// All rows of the table, and the work that fills them.
class Competition {
 public:
  explicit Competition(double hours) : hours_{hours} {}

  template <class Estimator>
  void enter(const char* name) {
    const std::size_t row = add(name);
    jobs_.emplace_back([this, row] { rows_[row].running = day<Estimator>(hours_); });
    jobs_.emplace_back([this, row] { rows_[row].quarter = standstill<Estimator>(kQuarterS); });
    jobs_.emplace_back([this, row] { rows_[row].shift = standstill<Estimator>(kShiftS); });
  }

  void enter_whole_chain() {
    const std::size_t first = rows_.size();
    for (const char* name : WholeChain::kNames) add(name);
    const auto store = [this, first](Outcome Row::*place, const WholeChain::Outcomes& outcomes) {
      for (std::size_t m = 0; m < outcomes.size(); ++m) rows_[first + m].*place = outcomes[m];
    };
    jobs_.emplace_back(
        [=, this] { store(&Row::running, WholeChain::day(kDriveS, 3600.0 * hours_)); });
    jobs_.emplace_back([=] { store(&Row::quarter, WholeChain::standstill(kDriveS, kQuarterS)); });
    jobs_.emplace_back([=] { store(&Row::shift, WholeChain::standstill(kDriveS, kShiftS)); });
  }

  /// On every core.
  void run() {
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
      for (std::size_t job = next++; job < jobs_.size(); job = next++) jobs_[job]();
    };
    std::vector<std::thread> threads(std::max(1U, std::thread::hardware_concurrency()));
    for (std::thread& thread : threads) thread = std::thread{work};
    for (std::thread& thread : threads) thread.join();
  }

  [[nodiscard]] const std::vector<Row>& rows() const noexcept { return rows_; }

 private:
  std::size_t add(const char* name) {
    rows_.push_back({.name = name});
    return rows_.size() - 1;
  }

  double hours_;
  std::vector<Row> rows_;
  std::vector<std::function<void()>> jobs_;  // the longest first
};

void print(const Row& row, double hours, nlohmann::json& out) {
  fmt::print("| {} | {:.1e} | {} | {} | {} |\n", row.name, row.running.error_before,
             text(row.running), text(row.quarter), text(row.shift));
  out["robustness"].push_back({{"name", row.name},
                               {"hours", hours},
                               {"running", json_of(row.running)},
                               {"standstill_900_s", json_of(row.quarter)},
                               {"standstill_28800_s", json_of(row.shift)}});
}

int run(int argc, char** argv) {
  double hours = 24.0;
  std::string path;
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::string_view{argv[i]} == "--hours") hours = std::atof(argv[i + 1]);
    if (std::string_view{argv[i]} == "--json") path = argv[i + 1];
  }
  Competition competition{hours};
  competition.enter_whole_chain();
  competition.enter<OursGated<kUnknowns>>("dampline, standstill left out as the Estimator does");
  competition.enter<Ours<kUnknowns>>("dampline, given every row");
  competition.enter<EigenCovariance<kUnknowns>>("Eigen, covariance recursion");
  competition.enter<EigenSymmetric<kUnknowns>>("Eigen, one triangle of the covariance");
#ifdef DAMPLINE_HAS_DLIB
  competition.enter<Dlib<kUnknowns>>("dlib::rls");
  competition.enter<DlibForgetful<kUnknowns>>("dlib::rls, forgetting its prior too");
#endif
#ifdef DAMPLINE_HAS_ARMADILLO
  competition.enter<Armadillo<kUnknowns>>("Armadillo, covariance recursion");
#endif
#ifdef DAMPLINE_HAS_LIQUID
  competition.enter<Liquid<kUnknowns>>("liquid eqrls_rrrf");
#endif
  competition.run();
  fmt::print(
      "300 Hz. Estimator: the larger relative error of friction and stiffness of a simulated car. "
      "Others: {} unknowns, forgetting {}, the largest error of a parameter\n\n"
      "| estimator | after 5 min | after {:.1f} h of running | 5 min after 15 min of "
      "standstill | 5 min after 8 h of standstill |\n|--|--|--|--|--|\n",
      kUnknowns, kForgetting, hours);
  nlohmann::json out;
  for (const Row& row : competition.rows()) print(row, hours, out);
  std::fputs(missing_peers(), stdout);
  if (!path.empty()) std::ofstream{path} << out.dump(2) << '\n';
  return 0;
}

}  // namespace
}  // namespace dampline::bench

int main(int argc, char** argv) { return dampline::bench::run(argc, argv); }
