// SPDX-License-Identifier: MIT
// The virtual hardware itself: what the other tests of this room stand on.
#include <gtest/gtest.h>
#include <sys/types.h>
#include <time.h>

#include <chrono>
#include <fstream>
#include <string>
#include <thread>

#include "tests/bus/bus.hpp"
#include "tests/bus/child.hpp"

namespace dampline::bus {
namespace {

using std::chrono::steady_clock;

/// Processor time is not virtual: how long something really took.
double processor_s() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

bool appears(const Child& child, const std::string& text) {
  for (int i = 0; i < 400 && child.output().find(text) == std::string::npos; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds{10});
  return child.output().find(text) != std::string::npos;
}

TEST(VirtualBus, CarriesAFrameFromOneProgramToAnother) {
  const Folder folder;
  const VirtualCan bus;
  Child candump{{"candump", "-L", "-n", "1", bus.name()}, folder.path()};
  RawSender sender{bus.name()};
  const CanFrame frame{.id = 0x310, .length = 4, .data = {0xDE, 0xAD, 0xBE, 0xEF}};
  // candump says nothing when it is ready.
  while (candump.running()) {
    ASSERT_TRUE(sender.send(frame));
    std::this_thread::sleep_for(std::chrono::milliseconds{10});
  }
  EXPECT_NE(candump.output().find(bus.name() + " 310#DEADBEEF"), std::string::npos);
  EXPECT_EQ(bus.carried(), sender.sent());
}

TEST(VirtualBus, RefusesFramesWhileDownOrAway) {
  VirtualCan bus;
  RawSender sender{bus.name()};
  const CanFrame frame{.id = 0x310, .length = 1};
  EXPECT_TRUE(sender.send(frame));
  bus.down();
  EXPECT_FALSE(sender.send(frame));
  bus.up();
  EXPECT_TRUE(sender.send(frame));
  bus.remove();
  EXPECT_FALSE(sender.send(frame));
  bus.create();
  sender.bind_again();
  EXPECT_TRUE(sender.send(frame));
}

TEST(VirtualBus, CarriesLongFramesAndErrorFrames) {
  const Folder folder;
  const VirtualCan bus;
  Child candump{{"candump", "-L", "-n", "2", bus.name() + ",0:0,#FFFFFFFF"}, folder.path()};
  std::this_thread::sleep_for(std::chrono::milliseconds{300});
  RawSender sender{bus.name()};
  ASSERT_TRUE(sender.send(CanFrame{.id = 0x123, .length = 64, .fd = true}));
  ASSERT_TRUE(sender.send(CanFrame{.id = 0x40, .length = 8, .error = true}));
  const Ended ended = candump.wait(std::chrono::seconds{5});
  EXPECT_NE(ended.output.find("123##"), std::string::npos) << ended.output;
  EXPECT_NE(ended.output.find("20000040#"), std::string::npos) << ended.output;
}

TEST(VirtualGpio, FollowsTheSimulatedPin) {
  const Folder folder;
  const std::filesystem::path chip = "/sys/kernel/config/gpio-sim/dampline_smoke";
  std::filesystem::create_directories(chip / "bank0");
  std::ofstream{chip / "bank0" / "num_lines"} << "4";
  std::ofstream{chip / "live"} << "1";
  const std::string name = read_file(chip / "bank0" / "chip_name");
  const std::string label = name.substr(0, name.find('\n'));
  const std::string device = read_file(chip / "dev_name");
  const std::filesystem::path pin = std::filesystem::path{"/sys/devices/platform"} /
                                    device.substr(0, device.find('\n')) / label / "sim_gpio2/pull";
  std::ofstream{pin} << "pull-up";
  EXPECT_EQ(run({"gpioget", label, "2"}), "1\n");
  std::ofstream{pin} << "pull-down";
  EXPECT_EQ(run({"gpioget", label, "2"}), "0\n");

  Child watch{{"gpiomon", "--num-events=2", "--format=%e at %s", label, "2"}, folder.path()};
  for (int i = 0; i < 400 && watch.running(); ++i) {
    std::ofstream{pin} << (i % 2 == 0 ? "pull-up" : "pull-down");
    std::this_thread::sleep_for(std::chrono::milliseconds{10});
  }
  EXPECT_TRUE(appears(watch, "0 at ")) << watch.error();
  EXPECT_TRUE(appears(watch, "1 at ")) << watch.output();
  std::ofstream{chip / "live"} << "0";
  std::filesystem::remove(chip / "bank0");
  std::filesystem::remove(chip);
}

TEST(TimeTravel, SleepsAnHourAtOnce) {
  const auto start = steady_clock::now();
  const double worked_s = processor_s();
  std::this_thread::sleep_for(std::chrono::hours{1});
  const std::chrono::duration<double> slept = steady_clock::now() - start;
  EXPECT_GE(slept.count(), 3600.0);
  EXPECT_LT(slept.count(), 3600.1);
  EXPECT_LT(processor_s() - worked_s, 1.0);
}

TEST(Machine, HasAClockOfItsOwn) {
  timespec now{};
  ASSERT_EQ(::clock_gettime(CLOCK_REALTIME, &now), 0);
  timespec set = now;
  set.tv_sec += 3600;
  ASSERT_EQ(::clock_settime(CLOCK_REALTIME, &set), 0);
  timespec after{};
  ASSERT_EQ(::clock_gettime(CLOCK_REALTIME, &after), 0);
  EXPECT_GE(after.tv_sec, now.tv_sec + 3600);
}

}  // namespace
}  // namespace dampline::bus
