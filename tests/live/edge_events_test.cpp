// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <vector>

#include "app/live/digital_lines.hpp"

namespace dampline::app {
namespace {

using hal::Edge;
using hal::Event;
using hal::EventKind;

constexpr std::int64_t kSecondNs = 1'000'000'000;

EdgeEvents three_lines() {
  return EdgeEvents{{LineKind::kPulsePerSecond, LineKind::kMarker, LineKind::kWheel}};
}

std::vector<EventKind> kinds(EdgeEvents& events, const Edge& edge) {
  std::vector<EventKind> all;
  for (const Event& event : events.take(edge)) {
    EXPECT_EQ(event.time_ns, edge.time_ns);
    EXPECT_EQ(event.line, edge.line);
    all.push_back(event.kind);
  }
  return all;
}

TEST(EdgeEvents, SayWhatALineTells) {
  EdgeEvents events = three_lines();
  using Kinds = std::vector<EventKind>;
  EXPECT_EQ(kinds(events, {.time_ns = 1, .line = 0, .rising = true}), Kinds{EventKind::kPulse});
  EXPECT_EQ(kinds(events, {.time_ns = 2, .line = 0, .rising = false}), Kinds{});
  EXPECT_EQ(kinds(events, {.time_ns = 3, .line = 1, .rising = true}), Kinds{EventKind::kMarkerOn});
  EXPECT_EQ(kinds(events, {.time_ns = 4, .line = 1, .rising = false}),
            Kinds{EventKind::kMarkerOff});
  EXPECT_EQ(kinds(events, {.time_ns = 5, .line = 2, .rising = true}),
            Kinds{EventKind::kWheelPulse});
  EXPECT_EQ(kinds(events, {.time_ns = 6, .line = 2, .rising = false}), Kinds{});
  EXPECT_EQ(kinds(events, {.time_ns = 7, .line = 3, .rising = true}), Kinds{});  // not declared
  EXPECT_EQ(events.counts().pulses, 1U);
  EXPECT_EQ(events.counts().markers, 2U);
  EXPECT_EQ(events.counts().wheel_pulses, 1U);
}

TEST(EdgeEvents, TellAndCountImpossibleSequences) {
  EdgeEvents events = three_lines();
  const Edge on{.time_ns = 9, .line = 1, .rising = true, .impossible = true};
  const auto told = events.take(on);
  ASSERT_EQ(told.size(), 2U);
  EXPECT_EQ(told[0].kind, EventKind::kImpossibleEdge);
  EXPECT_EQ(told[0].value, 1);
  EXPECT_EQ(told[1].kind, EventKind::kMarkerOn);
  const Edge off{.time_ns = 10, .line = 2, .rising = false, .impossible = true};
  const auto next = events.take(off);
  ASSERT_EQ(next.size(), 1U);
  EXPECT_EQ(next[0].kind, EventKind::kImpossibleEdge);
  EXPECT_EQ(next[0].value, -1);
  EXPECT_EQ(events.counts().impossible, 2U);
}

TEST(EdgeEvents, TellLossesFirst) {
  EdgeEvents events = three_lines();
  const auto told =
      events.take({.time_ns = 9, .line = 1, .rising = false, .impossible = true, .lost_before = 7});
  ASSERT_EQ(told.size(), EdgeEvents::kMostEvents);
  EXPECT_EQ(told[0].kind, EventKind::kEdgesLost);
  EXPECT_EQ(told[0].value, 7);
  EXPECT_EQ(told[1].kind, EventKind::kImpossibleEdge);
  EXPECT_EQ(told[2].kind, EventKind::kMarkerOff);
  EXPECT_EQ(events.counts().lost, 7U);
}

TEST(EdgeEvents, CountPulsesThatAreNotASecondApart) {
  EdgeEvents events = three_lines();
  std::int64_t now_ns = 1'700'000'000 * kSecondNs;
  const auto pulse = [&](std::int64_t after_ns) {
    now_ns += after_ns;
    static_cast<void>(events.take({.time_ns = now_ns, .line = 0, .rising = true}));
    return events.counts().implausible;
  };
  EXPECT_EQ(pulse(0), 0U);
  EXPECT_EQ(pulse(kSecondNs), 0U);
  EXPECT_EQ(pulse(kSecondNs + 1'000'000), 0U);  // just within
  EXPECT_EQ(pulse(kSecondNs - 1'000'000), 0U);
  EXPECT_EQ(pulse(kSecondNs + 1'000'001), 1U);
  EXPECT_EQ(pulse(kSecondNs), 1U);  // judged by the one before, not by the first
  EXPECT_EQ(pulse(kSecondNs - 1'000'001), 2U);
  EXPECT_EQ(pulse(2 * kSecondNs), 3U);  // one is missing
  EXPECT_EQ(pulse(10'000), 4U);         // one too many
  EXPECT_EQ(events.counts().pulses, 9U);
}

}  // namespace
}  // namespace dampline::app
