// SPDX-License-Identifier: MIT
// Wrong values and times of any size in a rig's record, from the file on: what they do is nothing,
// or it is named.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "app/diagnosis/rig/explain.hpp"
#include "app/error.hpp"
#include "app/rig/identify.hpp"
#include "app/rig/record.hpp"
#include "simulated_rig.hpp"
#include "tests/drivers/temporary_file.hpp"

namespace dampline::test {
namespace {

using app::Config;
using app::RunResult;
using app::rig::Line;
using testing::HasSubstr;

constexpr double kWrongRateHz = 500.0;
constexpr double kWithoutAFault = 0.5;  // deviations
constexpr double kAtAll = 1.0;          // named ones cost their samples, and nothing else

/// A rig, and what is identified of it.
struct Case {
  std::string name;
  std::vector<Line> lines;
  Config config;
  bool velocity{false};
};

Case driven_mass() {
  SimulatedRig rig{{50.0, 120.0, 2.0e4, 30.0, 0.0},
                   {{190.0, 0.9, 0.3}, {150.0, 2.3, 1.1}, {120.0, 4.7, 2.0}}};
  Case out{"driven mass", {}, {}, false};
  for (const rig::Sample& s : rig.record(kWrongRateHz, 40.0, {2e-6, 0.0, 2.0, 0.0}, 7))
    out.lines.push_back({0, static_cast<double>(s.tick) / kWrongRateHz, s.deflection_m,
                         std::numeric_limits<double>::quiet_NaN(), s.force_n});
  out.config.model.base = {"coulomb", "viscous"};
  out.config.model.inertia = "identify";
  out.config.model.stiffness = "identify";
  return out;
}

Case damper(bool velocity) {
  std::mt19937_64 random{11};
  std::normal_distribution<double> noise;
  Case out{velocity ? "damper, velocity measured" : "damper", {}, {}, velocity};
  for (int i = 0; i < 20'000; ++i) {
    const double t = i / kWrongRateHz;
    const double v = 0.02 * 9.0 * std::cos(9.0 * t) + 0.01 * 17.0 * std::cos(17.0 * t + 0.4);
    const double x = 0.02 * std::sin(9.0 * t) + 0.01 * std::sin(17.0 * t + 0.4);
    out.lines.push_back(
        {0, t, x + 2e-6 * noise(random),
         velocity ? v + 1e-4 * noise(random) : std::numeric_limits<double>::quiet_NaN(),
         std::copysign(500.0, v) + 2000.0 * v + 20.0 * noise(random)});
  }
  out.config.model.base = {"coulomb", "viscous"};
  return out;
}

std::string csv_of(const Case& rig) {
  std::string text =
      rig.velocity ? "time_s,deflection_m,force_n,velocity_mps\n" : "time_s,deflection_m,force_n\n";
  for (const Line& l : rig.lines) {
    text += fmt::format("{},{},{}", l.time_s, l.deflection_m, l.force_n);
    text += rig.velocity ? fmt::format(",{}\n", l.velocity_mps) : "\n";
  }
  return text;
}

RunResult identify(const Case& rig, bool skip_bad_lines = false) {
  const TemporaryFile file{csv_of(rig), ".csv"};
  return app::rig::identify(app::rig::csv_record(file.path(), rig.config.input, skip_bad_lines),
                            rig.config);
}

/// The largest move of a parameter, in the deviations that it has without the wrong values.
double moved(const std::vector<app::Parameter>& from, const std::vector<app::Parameter>& to) {
  double most = 0.0;
  for (const app::Parameter& p : from) {
    const auto same = std::find_if(
        to.begin(), to.end(), [&](const app::Parameter& other) { return other.name == p.name; });
    const double move = same == to.end() ? HUGE_VAL : std::abs(same->value - p.value) / p.std;
    most = std::isfinite(move) ? std::max(most, move) : HUGE_VAL;
  }
  return most;
}

bool names(const std::vector<app::FaultFinding>& faults, const std::string& channel) {
  return std::any_of(faults.begin(), faults.end(), [&](const app::FaultFinding& f) {
    return f.name == "wrong_value" && f.channel == channel && f.count > 0;
  });
}

std::uint64_t counted(const RunResult& result, const std::string& name) {
  for (const auto& [key, value] : result.counts)
    if (key == name) return value;
  return 0;
}

/// One or ten wrong values: one, ten in a row, or ten anywhere.
struct Wrong {
  std::string channel;
  std::vector<std::size_t> rows;
  double value{0.0};
  bool is_number{true};
};

/// Sizes over 300 decades, half of them within a thousand times what the channel reaches. Ten in a
/// row begin at twice that where the quantity may jump: a force that changes to one of its usual
/// values and back while the motion turns is what friction does.
Wrong wrong_of(std::mt19937_64& random, const Case& rig) {
  std::vector<std::pair<std::string, double Line::*>> channels{
      {"deflection_m", &Line::deflection_m}, {"force_n", &Line::force_n}};
  if (rig.velocity) channels.emplace_back("velocity_mps", &Line::velocity_mps);
  const auto& [name, member] = channels[random() % channels.size()];
  double reach = 0.0;
  for (const Line& l : rig.lines) reach = std::max(reach, std::abs(l.*member));
  Wrong out{name, {}, 0.0, true};
  std::uniform_real_distribution<double> share;
  const double decades = random() % 2 == 0 ? 3.0 * share(random) : 300.0 * share(random);
  out.value = (random() % 2 == 0 ? 1.0 : -1.0) * reach * std::pow(10.0, decades);
  const std::size_t how = random() % 3;
  if (how == 1 && name != "deflection_m") out.value *= 2.0;
  if (random() % 10 == 0) out.value = std::copysign(HUGE_VAL, out.value);
  out.is_number = std::isfinite(out.value);
  const std::size_t at = random() % (rig.lines.size() - 10);
  for (std::size_t k = 0; k < (how == 0 ? 1 : 10); ++k)
    out.rows.push_back(how == 1 ? at + k : how == 2 ? random() % rig.lines.size() : at);
  return out;
}

Case with(Case rig, const Wrong& wrong) {
  for (const std::size_t row : wrong.rows) {
    if (wrong.channel == "deflection_m") rig.lines[row].deflection_m = wrong.value;
    if (wrong.channel == "force_n") rig.lines[row].force_n = wrong.value;
    if (wrong.channel == "velocity_mps") rig.lines[row].velocity_mps = wrong.value;
  }
  return rig;
}

std::string text_of(const Case& rig, const Wrong& wrong) {
  return fmt::format("{}: {} of {} {} from row {}{}", rig.name, wrong.rows.size(), wrong.value,
                     wrong.channel, wrong.rows.front(),
                     wrong.rows.back() == wrong.rows.front() + 9 ? " on" : "");
}

TEST(WrongValues, OfAnySizeAndPlaceMoveNothingOfARigOrAreNamed) {
#if defined(DAMPLINE_SANITIZED)
  constexpr int kEach = 8;  // each takes ten times as long there
#else
  constexpr int kEach = 40;
#endif
  for (const Case& rig : {driven_mass(), damper(false), damper(true)}) {
    const RunResult reference = identify(rig);
    ASSERT_TRUE(reference.faults.list.empty()) << rig.name;
    std::mt19937_64 random{29};
    for (int i = 0; i < kEach; ++i) {
      const Wrong wrong = wrong_of(random, rig);
      const RunResult result = identify(with(rig, wrong));
      const double move = moved(reference.parameters, result.parameters);
      const bool named = wrong.is_number
                             ? names(result.faults.list, wrong.channel)
                             : counted(result, "not_finite") >= 1 && !result.excluded.empty();
      EXPECT_LT(move, named ? kAtAll : kWithoutAFault) << text_of(rig, wrong);
      EXPECT_EQ(result.trust, reference.trust) << text_of(rig, wrong);
    }
  }
}

TEST(WrongValues, LeaveAnExplanationsBaseWhereItIs) {
  Case rig = damper(false);
  rig.config.model.candidates = {"viscous"};
  rig.config.model.base_is_set = true;
  const auto explained = [](const Case& one) {
    const TemporaryFile file{csv_of(one), ".csv"};
    return app::rig::explain(one.config, {{file.path()}, {}, "", false});
  };
  const app::rig::Explanation reference = explained(rig);
  std::mt19937_64 random{31};
  for (int i = 0; i < 8; ++i) {
    const Wrong wrong = wrong_of(random, rig);
    const app::rig::Explanation found = explained(with(rig, wrong));
    EXPECT_EQ(found.steps.size(), reference.steps.size()) << text_of(rig, wrong);
    EXPECT_LT(moved(reference.base.parameters, found.base.parameters),
              names(found.faults, wrong.channel) ? kAtAll : kWithoutAFault)
        << text_of(rig, wrong);
  }
}

TEST(WrongTimes, AreErrorsWithTheirLineOrAreDropped) {
  const Case rig = damper(false);
  const RunResult reference = identify(rig);
  std::mt19937_64 random{37};
  for (const double ahead_s : {3.0, 3600.0, 7e9, 1e155, -3.0, -7e9, -1e300}) {
    for (const std::size_t lines : {1U, 10U}) {
      const std::size_t at = 100 + random() % (rig.lines.size() - 200);
      Case late = rig;
      for (std::size_t i = at; i < at + lines; ++i) late.lines[i].time_s += ahead_s;
      try {
        (void)identify(late);
        ADD_FAILURE() << ahead_s << " s were taken";
      } catch (const app::RunError& e) {
        EXPECT_THAT(e.what(), HasSubstr(fmt::format(".csv:{}: time_s", at + 2))) << ahead_s;
      }
      const RunResult result = identify(late, true);
      EXPECT_LT(moved(reference.parameters, result.parameters), kWithoutAFault) << ahead_s;
      EXPECT_EQ(counted(result, "lines_malformed"), lines) << ahead_s;
      ASSERT_EQ(result.faults.list.size(), 1U) << ahead_s;
      EXPECT_EQ(result.faults.list.front().name, "wrong_time");
    }
  }
}

TEST(WrongTimes, ThatAreNoNumberCostTheirLines) {
  const Case rig = damper(false);
  const RunResult reference = identify(rig);
  for (const double none : {HUGE_VAL, -HUGE_VAL, std::numeric_limits<double>::quiet_NaN()}) {
    Case late = rig;
    late.lines[5000].time_s = none;
    for (const bool skip : {false, true}) {
      const RunResult result = identify(late, skip);
      EXPECT_LT(moved(reference.parameters, result.parameters), kWithoutAFault);
      EXPECT_EQ(counted(result, skip ? "lines_malformed" : "not_finite"), 1U);
    }
  }
}

// A pause is no fault, be it of an hour in the middle or of a day before the second line.
TEST(WrongTimes, ThatMayBePausesMoveNothing) {
  const Case rig = damper(false);
  const RunResult reference = identify(rig);
  for (const std::size_t from : {1U, 7000U, 19'999U}) {
    Case paused = rig;
    for (std::size_t i = from; i < rig.lines.size(); ++i) paused.lines[i].time_s += 86'400.0;
    const RunResult result = identify(paused);
    EXPECT_LT(moved(reference.parameters, result.parameters), kWithoutAFault) << from;
    for (std::size_t i = 0; i < result.parameters.size(); ++i)
      EXPECT_NEAR(result.parameters[i].std, reference.parameters[i].std,
                  0.2 * reference.parameters[i].std);
    EXPECT_EQ(counted(result, "gaps"), 1U);
  }
}

}  // namespace
}  // namespace dampline::test
