// SPDX-License-Identifier: MIT
// The live alarm on simulated months, as tables in Markdown: `months [CARS [FIRST_SEED]]`. First
// the scatter of its groups on simulated trucks; then months at the level of groups, with that
// scatter, heavier tails and weather: false alarms, and how long a change takes to be told.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/guard_cases.hpp"
#include "dampline/damping/estimator.hpp"
#include "dampline/guard/parameter_drift.hpp"

namespace {

using namespace dampline;
using namespace dampline::bench;

constexpr double kScatterRecordS = 1800.0;
constexpr int kGroupsPerDay = 12 * 60;  // twelve hours of motion a day
constexpr int kDays = 30;
constexpr double kGroupsPerHour = 60.0;

struct Scatter {
  double friction{0.0};
  double stiffness{0.0};
};

double deviation(const std::vector<double>& logs) {
  double mean = 0.0;
  for (const double x : logs) mean += x / static_cast<double>(logs.size());
  double sum = 0.0;
  for (const double x : logs) sum += (x - mean) * (x - mean);
  return std::sqrt(sum / static_cast<double>(logs.size() - 1));
}

Scatter measure(const GuardCondition& condition, std::uint64_t seed) {
  const GuardRecord record = clean_record(condition, seed);
  const auto identifier = std::make_unique<Estimator>(
      EstimatorConfig{.moving_mass_kg = record.simulation.truck.moving_mass_kg});
  const auto total = std::make_unique<ScaleFactors>();
  sim::Simulation simulation{record.simulation};
  GroupMeter meter;
  GroupMeter::Group group;
  std::vector<double> friction;
  std::vector<double> stiffness;
  for (int i = 0; i < static_cast<int>(kScatterRecordS * sim::kSampleRateHz); ++i) {
    if (!identifier->update(sim::to_sample(simulation.next())).block_closed) continue;
    identifier->export_total(*total);
    if (!meter.update(*total, group)) continue;
    friction.push_back(std::log(group.friction_mps2));
    stiffness.push_back(std::log(group.stiffness_ps2));
  }
  return {deviation(friction), deviation(stiffness)};
}

/// Weather: a wave a day, and what comes and goes over a day or so. Shares of the level.
struct Weather {
  std::string name;
  double day{0.0};
  double slow{0.0};
};

/// What happens to the car, in the second half of the month.
struct Event {
  std::string name;
  double friction{1.0};
  double stiffness{1.0};
  double days{0.0};  ///< that it takes; 0: at once
};

/// One car for a month at the level of groups.
class Month {
 public:
  Month(const Scatter& scatter, Weather weather, Event event, std::uint64_t seed)
      : scatter_{scatter},
        weather_{std::move(weather)},
        event_{std::move(event)},
        random_{seed, sim::Stream::kFaults} {
    start_ = static_cast<int>((15.0 + 5.0 * random_.uniform()) * kGroupsPerDay);
    phase_ = 2.0 * std::numbers::pi * random_.uniform();
    slow_ = random_.normal();
  }
  struct Outcome {
    int false_alarms{0};
    int quiet_groups{0};         // without an event
    std::optional<int> delay{};  // groups from the beginning of the event
    std::optional<DriftingParameter> named{};
  };
  Outcome run() {
    Outcome out;
    ChangeWatch watch;
    ChangeAlarm alarm;
    for (int n = 0; n < kDays * kGroupsPerDay; ++n) {
      const bool told = watch.update(friction(n), stiffness(n), alarm);
      const bool before = event_.name.empty() || n < start_;
      if (before) ++out.quiet_groups;
      if (told && before) ++out.false_alarms;
      if (!told || before) continue;
      out.delay = n - start_ + 1;
      out.named = alarm.parameter;
      return out;
    }
    return out;
  }

 private:
  /// A car stands half the day: between two groups of different days half a day passes.
  double weather(int n) {
    const double hours = n % kGroupsPerDay == 0 ? 12.0 : 1.0 / kGroupsPerHour;
    const double keep = std::exp(-hours / 24.0);
    slow_ = keep * slow_ + std::sqrt(1.0 - keep * keep) * random_.normal();
    const double day = 2.0 * std::numbers::pi * (n % kGroupsPerDay) / (2.0 * kGroupsPerDay);
    return weather_.day * std::sin(day + phase_) + weather_.slow * slow_;
  }
  /// Student's t with 5 degrees of freedom, deviation 1.
  double noise() {
    double squares = 0.0;
    for (int i = 0; i < 5; ++i) {
      const double x = random_.normal();
      squares += x * x;
    }
    return random_.normal() / std::sqrt(squares / 3.0);
  }
  double share(int n) const {
    if (event_.name.empty() || n < start_) return 0.0;
    if (event_.days == 0.0) return 1.0;
    return std::min(static_cast<double>(n - start_) / (event_.days * kGroupsPerDay), 1.0);
  }
  double friction(int n) {
    const double level = 1.0 + (event_.friction - 1.0) * share(n);
    return level * std::exp(weather(n) + scatter_.friction * noise());
  }
  double stiffness(int n) {
    const double level = 1.0 + (event_.stiffness - 1.0) * share(n);
    return level * std::exp(scatter_.stiffness * noise());
  }

  Scatter scatter_;
  Weather weather_;
  Event event_;
  sim::Random random_;
  int start_{0};
  double phase_{0.0};
  double slow_{0.0};
};

std::string duration(double groups) {
  if (groups < 120.0) return fmt::format("{:.0f} min", groups);
  if (groups < kGroupsPerDay) return fmt::format("{:.1f} h", groups / kGroupsPerHour);
  return fmt::format("{:.1f} days", groups / kGroupsPerDay);
}

void judge(const Scatter& scatter, const Weather& weather, const Event& event, int cars,
           std::uint64_t seed) {
  int false_alarms = 0;
  double hours = 0.0;
  std::vector<double> delays;
  std::array<int, 3> named{};
  for (int i = 0; i < cars; ++i) {
    const auto outcome = Month{scatter, weather, event, seed + static_cast<std::uint64_t>(i)}.run();
    false_alarms += outcome.false_alarms;
    hours += outcome.quiet_groups / kGroupsPerHour;
    if (outcome.delay) delays.push_back(*outcome.delay);
    if (outcome.named) ++named[static_cast<std::size_t>(*outcome.named)];
  }
  std::sort(delays.begin(), delays.end());
  const auto quantile = [&](double q) {
    return delays.empty()
               ? "-"
               : duration(
                     delays[static_cast<std::size_t>(q * static_cast<double>(delays.size() - 1))]);
  };
  fmt::print("| {} | {} | {:.3f} ({} in {:.0f} h) | {} of {} | {} | {} | {}, {}, {} |\n",
             weather.name, event.name.empty() ? "nothing" : event.name, 1e3 * false_alarms / hours,
             false_alarms, hours, delays.size(), event.name.empty() ? 0 : cars, quantile(0.5),
             quantile(0.95), named[0], named[1], named[2]);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int cars = argc > 1 ? std::atoi(argv[1]) : 500;
  const auto seed = static_cast<std::uint64_t>(argc > 2 ? std::atoll(argv[2]) : 1);
  Scatter largest;
  fmt::print("| groups of a minute | deviation of friction | of stiffness |\n|--|--|--|\n");
  for (const GuardCondition& condition : kGuardConditions) {
    const Scatter s = measure(condition, seed);
    largest = {std::max(largest.friction, s.friction), std::max(largest.stiffness, s.stiffness)};
    fmt::print("| {} | {:.2f} % | {:.2f} % |\n", condition.name, 100.0 * s.friction,
               100.0 * s.stiffness);
  }
  const std::vector<Weather> weathers{
      {"none", 0.0, 0.0}, {"day 2 %, slow 1 %", 0.02, 0.01}, {"day 4 %, slow 3 %", 0.04, 0.03}};
  const std::vector<Event> events{{"", 1.0, 1.0, 0.0},
                                  {"friction -10 % at once", 0.9, 1.0, 0.0},
                                  {"friction -20 % at once", 0.8, 1.0, 0.0},
                                  {"wedge wears, -30 % in 10 days", 0.7, 1.0, 10.0},
                                  {"stiffness -15 % at once (spring)", 1.0, 0.85, 0.0},
                                  {"load lost, mass -30 %", 1.0 / 0.7, 1.0 / 0.7, 0.0}};
  fmt::print(
      "\n| weather | what happens | false alarms per 1,000 h of motion | told | half of them "
      "within "
      "| 95 % within | named coulomb, stiffness, moving_mass |\n|--|--|--|--|--|--|--|\n");
  for (const Weather& weather : weathers) {
    for (const Event& event : events) judge(largest, weather, event, cars, seed);
  }
  return EXIT_SUCCESS;
}
