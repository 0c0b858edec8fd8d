// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <memory>
#include <string>

#include "drivers/gpiod/lines.hpp"
#include "tests/contract/edge_source_contract.hpp"
#include "tests/fault/fault_plan.hpp"
#include "tests/fault/gpiod_model.hpp"

namespace dampline::fault {
namespace {

using drivers::EdgeConfig;
using drivers::open_edges;

constexpr std::int64_t kOffsetNs = 1'000'000'000;

EdgeConfig two_lines() {
  return {.chip = "gpiochip_model",
          .lines = {{.offset = 2}, {.offset = 6, .active_low = true, .falling = false}},
          .run_time = {kOffsetNs}};
}

/// Alternating edges of line 2, 1 us apart.
class Train {
 public:
  explicit Train(GpioModel& model) : model_{model} {}
  void send(int edges) {
    for (int i = 0; i < edges; ++i) {
      ++sent_;
      model_.edge(2, sent_ % 2 == 1, sent_ * 1000);
    }
  }

 private:
  GpioModel& model_;
  std::int64_t sent_{0};
};

TEST(GpiodEdges, KeepTheContract) {
  GpioModel model;
  auto source = open_edges(two_lines());
  ASSERT_TRUE(source.ok()) << source.error_text();
  std::int64_t now_ns = 5;
  check_edge_source_contract(*source.value(),
                             [&](bool active) { model.edge(2, active, ++now_ns); });
  model.remove();
  check_gone(*source.value());
}

TEST(GpiodEdges, AskForWhatWasConfigured) {
  GpioModel model;
  auto source = open_edges(two_lines());
  ASSERT_TRUE(source.ok()) << source.error_text();
  EXPECT_EQ(model.lines_in_use(), 2);
  EXPECT_FALSE(model.active_low(2));
  EXPECT_TRUE(model.active_low(6));
  model.edge(6, false, 10);  // not watched
  model.edge(6, true, 20);
  model.edge(2, false, 30);
  const std::vector<hal::Edge> edges = read_all(*source.value());
  ASSERT_EQ(edges.size(), 2U);
  for (const hal::Edge& edge : edges) {
    EXPECT_EQ(edge.time_ns, kOffsetNs + (edge.line == 1 ? 20 : 30));
    EXPECT_EQ(edge.rising, edge.line == 1);
  }
  EXPECT_NE(edges[0].line, edges[1].line);
}

TEST(GpiodEdges, LetNoBusyLineKeepTheOthersWaiting) {
  GpioModel model;
  auto source = open_edges(two_lines());
  ASSERT_TRUE(source.ok()) << source.error_text();
  Train train{model};
  train.send(8);
  model.edge(6, true, 9);
  std::array<hal::Edge, 4> out{};
  std::size_t reads = 0;
  bool other = false;
  while (!other && reads < 4) {
    const std::size_t count = source.value()->read(out).value();
    for (std::size_t i = 0; i < count; ++i) other = other || out[i].line == 1;
    ++reads;
    if (drivers::gpio_library().starts_with("libgpiod 1")) train.send(4);  // stays full
  }
  EXPECT_TRUE(other) << reads;
}

TEST(GpiodEdges, ComeFromEachOfThreeLines) {
  GpioModel model;
  auto source = open_edges({.chip = "gpiochip_model",
                            .lines = {{.offset = 2}, {.offset = 4}, {.offset = 6}},
                            .run_time = {kOffsetNs}});
  ASSERT_TRUE(source.ok()) << source.error_text();
  for (const unsigned offset : {2U, 4U, 6U}) model.edge(offset, true, 10 * offset);
  std::array<int, 3> edges{};
  for (const hal::Edge& edge : read_all(*source.value())) ++edges.at(edge.line);
  EXPECT_EQ(edges, (std::array{1, 1, 1}));
}

/// What a full queue costs, and who notices: libgpiod 2 counts, libgpiod 1 sees an odd number as
/// two edges of one direction and an even one not at all.
class Overrun : public testing::TestWithParam<int> {};

TEST_P(Overrun, IsCountedAsFarAsTheLibraryTells) {
  GpioModel model;
  auto source = open_edges(two_lines());
  ASSERT_TRUE(source.ok()) << source.error_text();
  const bool counts = source.value()->health().lost.has_value();
  const int room = counts ? 1024 : static_cast<int>(GpioModel::kQueueV1);
  const int beyond = GetParam();
  Train train{model};
  train.send(room + beyond);
  const std::size_t kept = read_all(*source.value()).size();
  train.send(2);
  const std::size_t later = read_all(*source.value()).size();
  EXPECT_EQ(kept + later, static_cast<std::size_t>(room) + 2);
  const hal::EdgeHealth health = source.value()->health();
  EXPECT_EQ(health.edges, kept + later);
  if (counts) {
    EXPECT_EQ(health.lost, static_cast<std::uint64_t>(beyond));
    EXPECT_EQ(health.impossible, 0U);
    EXPECT_EQ(health.edges + health.lost.value(), static_cast<std::uint64_t>(room + beyond + 2));
  } else {
    EXPECT_EQ(health.impossible, beyond % 2 == 1 ? 1U : 0U);
  }
}

INSTANTIATE_TEST_SUITE_P(ByEdges, Overrun, testing::Values(0, 1, 2, 17, 100));

TEST(GpiodEdges, DeliverWhatCameBeforeTheChipWent) {
  GpioModel model;
  auto source = open_edges(two_lines());
  ASSERT_TRUE(source.ok()) << source.error_text();
  Train train{model};
  train.send(3);
  EXPECT_EQ(read_all(*source.value()).size(), 3U);
  model.remove();
  check_gone(*source.value());
  EXPECT_EQ(source.value()->health().edges, 3U);
}

struct Tally {
  std::uint64_t edges{0};
  std::uint64_t errors{0};
};

/// Four rounds of two edges each, waited for and read.
Tally run(hal::EdgeSource& source, GpioModel& model) {
  Train train{model};
  std::array<hal::Edge, 8> out{};
  Tally tally;
  for (int round = 0; round < 4; ++round) {
    train.send(2);
    if (!source.wait(std::chrono::milliseconds{10}).ok()) ++tally.errors;
    const Result<std::size_t> count = source.read(out);
    tally.edges += count.ok() ? count.value() : 0;
    tally.errors += count.ok() ? 0U : 1U;
  }
  return tally;
}

void check_failed_opening(const std::string& text, const ArmedFault& fault) {
  EXPECT_GT(fault.fired(), 0U) << text;
  EXPECT_NE(text.find("/dev/gpiochip_model"), std::string::npos) << text;
  EXPECT_NE(text.find("expected"), std::string::npos) << text;
}

void check_run(hal::EdgeSource& source, GpioModel& model, const ArmedFault& fault) {
  const Tally tally = run(source, model);
  EXPECT_EQ(tally.edges, source.health().edges);
  EXPECT_EQ(source.health().impossible, 0U);
  EXPECT_EQ(source.health().lost.value_or(0), 0U);
  EXPECT_TRUE(tally.edges == 8 || tally.errors > 0) << "edges missing without a word";
  EXPECT_TRUE(fault.fired() > 0 || tally.errors == 0);
}

/// The Nth call fails, for N = 1, 2, ... until a run meets no failure.
void fail_each_call(Call call, int error, bool for_ever) {
  std::uint64_t fired = 1;
  for (std::uint64_t nth = 1; fired > 0; ++nth) {
    SCOPED_TRACE(nth);
    GpioModel model;
    const ArmedFault fault{{.call = call, .nth = nth, .error = error, .for_ever = for_ever}};
    if (auto source = open_edges(two_lines()); source.ok()) {
      check_run(*source.value(), model, fault);
      source.value().reset();
    } else {
      check_failed_opening(source.error_text(), fault);
    }
    EXPECT_EQ(model.objects(), 0) << "an object is left behind";
    EXPECT_EQ(model.lines_in_use(), 0) << "a line stays requested";
    fired = fault.fired();
    ASSERT_LT(nth, 200U);
  }
}

TEST(GpiodEdges, SurviveEachFailingCallOfTheLibrary) {
  fail_each_call(Call::kGpio, EIO, false);
  fail_each_call(Call::kGpio, EIO, true);
  fail_each_call(Call::kGpio, ENODEV, false);
}

TEST(GpiodEdges, SurviveEachFailingCallOfTheKernel) {
  fail_each_call(Call::kFcntl, EBADF, false);
  fail_each_call(Call::kPpoll, ENOMEM, false);
  fail_each_call(Call::kPpoll, ENOMEM, true);
}

TEST(GpiodEdges, TakeASignalWhileWaitingForNothingToRead) {
  GpioModel model;
  auto source = open_edges(two_lines());
  ASSERT_TRUE(source.ok()) << source.error_text();
  const ArmedFault fault{{.call = Call::kPpoll, .error = EINTR}};
  const Result<bool> ready = source.value()->wait(std::chrono::seconds{10});
  ASSERT_TRUE(ready.ok());
  EXPECT_FALSE(ready.value());
}

TEST(GpiodEdges, SayWhichLineCannotBeHad) {
  GpioModel model;
  EdgeConfig config = two_lines();
  auto first = open_edges(config);
  ASSERT_TRUE(first.ok());
  config.lines = {{.offset = 2}};
  const auto second = open_edges(config);
  ASSERT_FALSE(second.ok());
  EXPECT_NE(second.error_text().find("line 2: "), std::string::npos) << second.error_text();
  EXPECT_NE(second.error_text().find("somebody else has it"), std::string::npos);
  config.lines = {{.offset = 99}};
  const auto third = open_edges(config);
  ASSERT_FALSE(third.ok());
  EXPECT_NE(third.error_text().find("line 99: "), std::string::npos) << third.error_text();
  EXPECT_NE(third.error_text().find("expected a line that the chip has"), std::string::npos);
}

}  // namespace
}  // namespace dampline::fault
