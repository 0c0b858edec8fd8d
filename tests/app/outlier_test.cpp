// SPDX-License-Identifier: MIT
// Wrong values and times of any size in a truck's record, through the whole program: what they do
// is nothing, or it is named.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "tests/app/program.hpp"

namespace dampline::app {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class Outliers : public testing::Test {
 protected:
  using json = nlohmann::json;

  Outliers() {
    EXPECT_EQ(program_.run("simulate --duration 120 --seed 3 --quiet --out base.csv").code, 0);
    std::istringstream text{program_.read("base.csv")};
    std::getline(text, header_);
    for (std::string line; std::getline(text, line);) {
      std::vector<std::string> cells;
      std::istringstream row{line};
      for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
      rows_.push_back(cells);
    }
    reference_ = identify(rows_);
  }
  json identify(const std::vector<std::vector<std::string>>& rows, const std::string& flags = "") {
    std::string text = header_ + "\n";
    for (const auto& row : rows) {
      for (std::size_t i = 0; i < row.size(); ++i) text += (i == 0 ? "" : ",") + row[i];
      text += "\n";
    }
    program_.write("run.csv", text);
    outcome_ = program_.run("identify run.csv --out o --force --quiet --no-report --json " + flags);
    return outcome_.code == 0 ? json::parse(outcome_.output) : json{};
  }
  /// The largest move of a parameter, in its deviations.
  [[nodiscard]] double moved(const json& result) const {
    double most = 0.0;
    for (const char* name : {"coulomb", "stiffness"}) {
      const auto of = [&](const json& all) {
        for (const json& p : all.at("parameters"))
          if (p.at("name") == name) return p;
        return json{{"value", 1e300}, {"std", 1.0}};
      };
      most = std::max(most, std::fabs(of(result).at("value").get<double>() -
                                      of(reference_).at("value").get<double>()) /
                                of(reference_).at("std").get<double>());
    }
    return most;
  }

  const Program program_;
  std::string header_;
  std::vector<std::vector<std::string>> rows_;
  json reference_;
  Program::Outcome outcome_;
};

TEST_F(Outliers, OfAnySizeMoveNothingOrAreNamed) {
  std::mt19937 random{5};
  constexpr std::size_t kFrame = 1;
  ASSERT_THAT(header_, StartsWith("time_s,frame_accel_mps2,"));
  std::size_t channel = 0;
  for (const char* size : {"300", "-1e4", "9.9e5", "1e6", "-1e9", "1e155", "-1e308", "inf"}) {
    for (const auto& [count, step] : {std::pair{1, 0}, std::pair{10, 1}, std::pair{10, 977}}) {
      auto rows = rows_;
      const std::size_t at = 600 + random() % 20'000;
      for (int k = 0; k < count; ++k)
        rows[at + static_cast<std::size_t>(k * step)][kFrame + channel % 3] = size;
      ++channel;
      const json result = identify(rows);
      ASSERT_EQ(outcome_.code, 0) << size << outcome_.error;
      EXPECT_TRUE(moved(result) < 0.5 || !result.at("faults").empty())
          << size << ", " << count << " every " << step << ": " << moved(result);
    }
  }
}

TEST_F(Outliers, TimesThatAreNoneAreErrorsWithTheirLine) {
  for (const char* time : {"inf", "nan", "1e300", "7e9", "-inf"}) {
    auto rows = rows_;
    rows[1000][0] = time;
    identify(rows);
    EXPECT_EQ(outcome_.code, 1) << time;
    EXPECT_THAT(outcome_.error, HasSubstr("run.csv:1002")) << time;
    const json skipped = identify(rows, "--skip-bad-lines");
    ASSERT_EQ(outcome_.code, 0) << time << outcome_.error;
    EXPECT_LT(moved(skipped), 0.5) << time;
  }
}

TEST_F(Outliers, TenLinesAnHourAheadCostTenLines) {
  auto rows = rows_;
  for (std::size_t i = 1000; i < 1010; ++i)
    rows[i][0] = std::to_string(3600.0 + std::stod(rows[i][0]));
  const json result = identify(rows, "--skip-bad-lines");
  ASSERT_EQ(outcome_.code, 0) << outcome_.error;
  EXPECT_LT(moved(result), 0.5);
  EXPECT_EQ(result.at("counts").at("lines_malformed"), 10);
}

TEST_F(Outliers, APauseOfAnHourIsAPause) {
  auto rows = rows_;
  for (std::size_t i = 18'000; i < rows.size(); ++i)
    rows[i][0] = std::to_string(3600.0 + std::stod(rows[i][0]));
  for (const char* flags : {"", "--skip-bad-lines"}) {
    const json result = identify(rows, flags);
    ASSERT_EQ(outcome_.code, 0) << outcome_.error;
    EXPECT_LT(moved(result), 1.0) << flags;
  }
}

}  // namespace
}  // namespace dampline::app
