// SPDX-License-Identifier: MIT
// Without the privilege for it a live run goes on, and says what it lacks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/live/process.hpp"
#include "tests/fault/fault_plan.hpp"

namespace dampline::fault {
namespace {

using ::testing::HasSubstr;

TEST(Realtime, SaysThatMemoryCouldNotBeLockedAndHowToAllowIt) {
  const ArmedFault fault{{Call::kMlockall, 1, EPERM}};
  app::Realtime realtime;
  app::lock_memory(realtime);
  EXPECT_EQ(fault.fired(), 1U);
  EXPECT_FALSE(realtime.memory_locked);
  EXPECT_FALSE(realtime.whole());
  ASSERT_EQ(realtime.problems.size(), 1U);
  EXPECT_THAT(realtime.problems[0], HasSubstr("Operation not permitted"));
  EXPECT_THAT(realtime.problems[0], HasSubstr("LimitMEMLOCK"));
}

TEST(Realtime, SaysThatTheSchedulerRefusedAndHowToAllowIt) {
  const ArmedFault fault{{Call::kSetschedparam, 1, EPERM}};
  app::Realtime realtime;
  app::schedule_fifo(50, realtime);
  EXPECT_EQ(fault.fired(), 1U);
  EXPECT_FALSE(realtime.scheduled);
  ASSERT_EQ(realtime.problems.size(), 1U);
  EXPECT_THAT(realtime.problems[0], HasSubstr("SCHED_FIFO 50"));
  EXPECT_THAT(realtime.problems[0], HasSubstr("LimitRTPRIO=50"));
}

TEST(Realtime, AsksForNothingAtPriorityZero) {
  const ArmedFault fault{{Call::kSetschedparam, 1, EPERM}};
  app::Realtime realtime;
  app::schedule_fifo(0, realtime);
  EXPECT_EQ(fault.calls(), 0U);
  EXPECT_TRUE(realtime.problems.empty());
}

}  // namespace
}  // namespace dampline::fault
