// SPDX-License-Identifier: MIT
// The GPIO driver on the kernel's simulated lines.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <ctime>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "app/live/digital_lines.hpp"
#include "drivers/gpiod/lines.hpp"
#include "tests/bus/gpio_sim.hpp"
#include "tests/contract/edge_source_contract.hpp"

namespace dampline::bus {
namespace {

using drivers::EdgeConfig;
using drivers::open_edges;
using drivers::open_output;

constexpr std::int64_t kOffsetNs = 1'700'000'000'000'000'000;

std::int64_t monotonic_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

EdgeConfig lines_of(const GpioSim& gpio) {
  return {.chip = gpio.chip(),
          .lines = {{.offset = 3}, {.offset = 5, .active_low = true, .falling = false}},
          .run_time = {kOffsetNs}};
}

TEST(GpioEdges, KeepTheContract) {
  GpioSim gpio;
  auto source = open_edges(lines_of(gpio));
  ASSERT_TRUE(source.ok()) << source.error_text();
  check_edge_source_contract(*source.value(), [&](bool active) { gpio.move(3, active); });
  gpio.remove();
  check_gone(*source.value());
}

/// Moves a line a thousand times and notes when.
class Mover {
 public:
  static constexpr std::size_t kEdges = 1000;
  explicit Mover(const GpioSim& gpio) {
    thread_ = std::thread{[this, &gpio] {
      for (std::size_t i = 0; i < kEdges; ++i) {
        before_ns_.push_back(monotonic_ns());
        gpio.move(3, i % 2 == 0);
        after_ns_.push_back(monotonic_ns());
      }
      done_ = true;
    }};
  }
  ~Mover() { thread_.join(); }
  Mover(const Mover&) = delete;
  Mover& operator=(const Mover&) = delete;
  [[nodiscard]] bool done() const { return done_; }
  [[nodiscard]] bool moved_at(std::size_t edge, std::int64_t ns) const {
    return before_ns_.at(edge) <= ns && ns <= after_ns_.at(edge);
  }

 private:
  std::vector<std::int64_t> before_ns_;
  std::vector<std::int64_t> after_ns_;
  std::atomic<bool> done_{false};
  std::thread thread_;
};

TEST(GpioEdgesNightly, LeaveNoneOfAThousandUnaccounted) {
  const GpioSim gpio;
  auto opened = open_edges(lines_of(gpio));
  ASSERT_TRUE(opened.ok()) << opened.error_text();
  hal::EdgeSource& source = *opened.value();
  std::vector<hal::Edge> edges;
  {
    const Mover mover{gpio};
    while (!mover.done() || source.wait(std::chrono::milliseconds{20}).value()) {
      if (!source.wait(std::chrono::milliseconds{20}).value()) continue;
      for (const hal::Edge& edge : read_all(source)) edges.push_back(edge);
    }
    ASSERT_EQ(edges.size(), Mover::kEdges);
    for (std::size_t i = 0; i < edges.size(); ++i) {
      EXPECT_EQ(edges[i].rising, i % 2 == 0) << i;
      EXPECT_TRUE(mover.moved_at(i, edges[i].time_ns - kOffsetNs)) << i;
      EXPECT_GE(edges[i].time_ns, edges[i > 0 ? i - 1 : 0].time_ns);
    }
  }
  const hal::EdgeHealth health = source.health();
  EXPECT_EQ(health.edges, Mover::kEdges);
  EXPECT_EQ(health.impossible, 0U);
  EXPECT_EQ(health.reordered, 0U);
  EXPECT_EQ(health.lost.value_or(0), 0U);
}

/// Nobody reads while `beyond` more edges come than the kernel keeps.
void overrun(unsigned beyond) {
  const GpioSim gpio;
  auto opened = open_edges(lines_of(gpio));
  ASSERT_TRUE(opened.ok()) << opened.error_text();
  hal::EdgeSource& source = *opened.value();
  const bool counts = source.health().lost.has_value();
  const unsigned kept = counts ? 1024 : 16;
  const unsigned all = kept + beyond + 2;
  for (unsigned i = 0; i < kept + beyond; ++i) gpio.move(3, i % 2 == 0);
  EXPECT_EQ(read_all(source).size(), kept);
  for (unsigned i = kept + beyond; i < all; ++i) gpio.move(3, i % 2 == 0);
  EXPECT_EQ(read_all(source).size(), 2U);
  const hal::EdgeHealth health = source.health();
  if (counts) {
    EXPECT_EQ(health.edges + health.lost.value(), all);
    EXPECT_EQ(health.impossible, 0U);
  } else {  // the library cannot tell; an odd number shows as two edges of one direction
    EXPECT_EQ(health.impossible, beyond % 2);
  }
}

TEST(GpioEdges, ShowALossOfAnOddNumber) { overrun(25); }
TEST(GpioEdges, CountALossOfAnEvenNumberWhereTheLibraryCan) { overrun(12); }

TEST(GpioEdges, TellLinesAndPolarityApart) {
  const GpioSim gpio;
  gpio.move(5, true);  // inactive
  auto source = open_edges(lines_of(gpio));
  ASSERT_TRUE(source.ok()) << source.error_text();
  gpio.move(5, false);  // active: a rising edge
  gpio.move(3, true);
  gpio.move(5, true);  // not watched
  gpio.move(5, false);
  std::vector<hal::Edge> of_five;
  std::size_t of_three = 0;
  for (const hal::Edge& edge : read_all(*source.value())) {
    EXPECT_TRUE(edge.rising);
    if (edge.line == 1) of_five.push_back(edge);
    of_three += edge.line == 0 ? 1U : 0U;
  }
  EXPECT_EQ(of_five.size(), 2U);
  EXPECT_EQ(of_three, 1U);
  EXPECT_EQ(source.value()->health().impossible, 0U);
}

TEST(GpioEdges, SayWhoCannotHaveALine) {
  const GpioSim gpio;
  const auto first = open_edges(lines_of(gpio));
  ASSERT_TRUE(first.ok()) << first.error_text();
  const auto second = open_edges(lines_of(gpio));
  ASSERT_FALSE(second.ok());
  EXPECT_NE(second.error_text().find("somebody else has it"), std::string::npos)
      << second.error_text();
  const auto beyond = open_edges({.chip = gpio.chip(), .lines = {{.offset = 8}}, .run_time = {}});
  ASSERT_FALSE(beyond.ok());
  EXPECT_NE(beyond.error_text().find("line 8"), std::string::npos) << beyond.error_text();
}

void follow(bool active_low) {
  const GpioSim gpio;
  auto output = open_output({.chip = gpio.chip(), .offset = 7, .active_low = active_low});
  ASSERT_TRUE(output.ok()) << output.error_text();
  EXPECT_EQ(gpio.high(7), active_low) << "dark when opened";
  app::StatusLamp lamp{std::move(output.value())};
  constexpr std::int64_t kTickNs = 50'000'000;
  std::int64_t now_ns = 0;
  for (const app::LampState state :
       {app::LampState::kIdentifying, app::LampState::kDegraded, app::LampState::kFault,
        app::LampState::kOff, app::LampState::kIdentifying}) {
    for (int i = 0; i < 60; ++i) {
      now_ns += kTickNs;
      lamp.show(state, now_ns);
      ASSERT_EQ(gpio.high(7), app::lamp_lit(state, now_ns) != active_low);
    }
  }
  EXPECT_EQ(lamp.failures(), 0U);
}

TEST(GpioLamp, FollowsTheState) { follow(false); }
TEST(GpioLamp, FollowsTheStateActiveLow) { follow(true); }

TEST(GpioLamp, SurvivesItsChip) {
  GpioSim gpio;
  auto output = open_output({.chip = gpio.chip(), .offset = 7});
  ASSERT_TRUE(output.ok()) << output.error_text();
  app::StatusLamp lamp{std::move(output.value())};
  lamp.show(app::LampState::kIdentifying, 0);
  gpio.remove();
  lamp.show(app::LampState::kOff, 1);
  EXPECT_EQ(lamp.failures(), 1U);
}

}  // namespace
}  // namespace dampline::bus
