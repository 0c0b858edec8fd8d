// SPDX-License-Identifier: MIT
// The program itself under several faults in one run: its parameters.json accounts for all frames.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <time.h>

#include <csignal>
#include <thread>

#include "tests/bus/bus.hpp"
#include "tests/bus/live_program.hpp"

namespace dampline::bus {
namespace {

using std::chrono::seconds;
using testing::HasSubstr;

void step_wall_clock(int by_s) {
  timespec now{};
  ASSERT_EQ(::clock_gettime(CLOCK_REALTIME, &now), 0);
  now.tv_sec += by_s;
  ASSERT_EQ(::clock_settime(CLOCK_REALTIME, &now), 0);
}

TEST(TimeTravelProgram, AccountsForAllFramesOfARunWithManyFaults) {
  const Folder folder;
  VirtualCan bus;
  LiveProgram live{folder, bus.name(), folder / "live"};
  Child simulate{simulate_command(bus.name(), 90.0, 1), folder.path()};
  std::this_thread::sleep_for(seconds{20});
  step_wall_clock(3600);
  std::this_thread::sleep_for(seconds{10});
  bus.down();
  std::this_thread::sleep_for(seconds{3});
  bus.up();
  std::this_thread::sleep_for(seconds{10});
  live.signal(SIGSTOP);
  std::this_thread::sleep_for(seconds{2});
  live.signal(SIGCONT);
  std::this_thread::sleep_for(seconds{10});
  bus.remove();
  std::this_thread::sleep_for(seconds{2});
  bus.create();
  std::this_thread::sleep_for(seconds{10});
  step_wall_clock(-3600);
  ASSERT_EQ(simulate.wait().status, 0);
  std::this_thread::sleep_for(seconds{1});
  const nlohmann::json counts = live.stop().at("counts");
  EXPECT_EQ(counts.at("frames_sent"), 81'000) << counts.dump(1);
  const auto count = [&](const char* name) { return counts.at(name).get<std::uint64_t>(); };
  EXPECT_EQ(count("frames_processed") + count("frames_dropped") + count("frames_missing") +
                count("frames_excluded"),
            81'000U);
  EXPECT_EQ(count("frames_excluded"), 0U);
  EXPECT_EQ(count("frames_dropped"), 0U);
  EXPECT_GE(count("frames_missing"), 4500U);  // of 5 s without a bus
  EXPECT_LE(count("frames_missing"), 4900U);
  EXPECT_THAT(read_file(live.run() / "events.csv"), HasSubstr("3600"));
}

#if defined(__x86_64__)

// Some of what tests/fault/live_calls does with every system call.
TEST(TimeTravelNightlyProgram, EndsWellOrSaysWhyWhateverCallFails) {
  const VirtualCan bus;
  run({DAMPLINE_SOURCE_DIR "/tests/fault/calls", "live=" + bus.name(), "--sample", "3", "--jobs",
       "1", "--build", DAMPLINE_BINARY_DIR});
}

#endif

}  // namespace
}  // namespace dampline::bus
