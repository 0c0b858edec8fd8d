// SPDX-License-Identifier: MIT
// The same frames give the same result, to the last bit, however they come.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <thread>

#include "tests/bus/bus.hpp"
#include "tests/bus/live_program.hpp"

namespace dampline::bus {
namespace {

TEST(TimeTravelSameFrames, GiveTheSameResultLiveAndFromBothRecords) {
  const Folder folder;
  const VirtualCan bus;
  Child candump{{"candump", "-L", bus.name()}, folder.path()};
  LiveProgram live{folder, bus.name(), folder / "live"};
  run(simulate_command(bus.name(), 90.0, 10));
  std::this_thread::sleep_for(std::chrono::seconds{1});
  const nlohmann::json result = live.stop();
  candump.signal(SIGTERM);
  static_cast<void>(candump.wait());
  const std::filesystem::path log = candump.output_file();

  const std::string text = read_file(log);
  ASSERT_EQ(std::count(text.begin(), text.end(), '\n'), 81'000);
  identify(log, folder / "candump");
  identify(folder / "live" / "blackbox", folder / "blackbox");
  const RunFiles from_bus = read_run(live.run());
  EXPECT_EQ(from_bus.parameters, read_run(folder / "candump").parameters);
  EXPECT_EQ(from_bus.parameters, read_run(folder / "blackbox").parameters);
  EXPECT_TRUE(from_bus == read_run(folder / "candump"));
  EXPECT_TRUE(from_bus == read_run(folder / "blackbox"));

  EXPECT_EQ(result.at("counts").at("samples"), 27'000);
  EXPECT_EQ(result.at("counts").at("frames_processed"), 81'000);
  EXPECT_EQ(result.at("counts").at("frames_excluded"), 0);
  EXPECT_EQ(result.at("live").at("records_lost"), 0);
}

}  // namespace
}  // namespace dampline::bus
