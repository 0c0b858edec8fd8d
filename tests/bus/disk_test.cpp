// SPDX-License-Identifier: MIT
// The live program over a disk that fills, goes read-only or loses the run directory: the run goes
// on, says so, and its result is somewhere.
#include "tests/bus/disk.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <time.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>

#include "app/run/state.hpp"
#include "tests/bus/bus.hpp"
#include "tests/bus/live_program.hpp"

namespace dampline::bus {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;
using testing::HasSubstr;

class TimeTravelDisk : public testing::Test {
 protected:
  TimeTravelDisk() { std::ofstream{folder_ / "car.toml"} << "[blackbox]\nreserve_free_mib = 0\n"; }
  [[nodiscard]] Words options() const {
    return {"--config", folder_ / "car.toml", "--publish-every", "1", "--realtime-priority", "0"};
  }
  [[nodiscard]] Child send(double duration_s) const {
    return Child{simulate_command(bus_.name(), duration_s, 10), folder_.path()};
  }
  [[nodiscard]] Words command(const fs::path& run) const {
    Words words{DAMPLINE_BINARY_DIR "/dampline",
                "identify",
                bus_.name(),
                "--out",
                run,
                "--no-report",
                "--no-blackbox"};
    const Words more = options();
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  const Folder folder_;
  const VirtualCan bus_;
};

TEST_F(TimeTravelDisk, ThatFillsAndEmptiesCostsPublicationsOnly) {
  const Disk disk{folder_ / "disk"};
  LiveProgram live{folder_, bus_.name(), folder_ / "disk/run", options()};
  Child sender = send(40.0);
  std::this_thread::sleep_for(seconds{15});
  disk.fill();
  std::this_thread::sleep_for(seconds{8});
  disk.empty();
  std::this_thread::sleep_for(seconds{10});
  ASSERT_EQ(sender.wait().status, 0);
  const nlohmann::json all = live.stop();
  EXPECT_GT(all.at("live").at("publish_failures").get<int>(), 2);
  const std::string events = read_file(live.run() / "events.csv");
  EXPECT_THAT(events, HasSubstr(",publish_failed,0,28"));  // ENOSPC
  EXPECT_THAT(events, HasSubstr(",publish_resumed,0,"));
  EXPECT_NEAR(value_of(all, "coulomb"), 8350.0, 400.0);
}

/// Samples of all segments in a spool; each is read whole.
std::uint64_t samples_in(const fs::path& spool) {
  const auto sums = std::make_unique<Statistics>();
  std::uint64_t out = 0;
  for (const auto& entry : fs::directory_iterator{spool})
    if (entry.path().extension() == ".dls") out += app::load_state(entry.path(), *sums).sequence;
  return out;
}

using TimeTravelNightlyDisk = TimeTravelDisk;

TEST_F(TimeTravelNightlyDisk, ThatFillsKeepsStatesWaitingAndAClockThatJumpsLosesNone) {
  const Disk disk{folder_ / "disk"};
  std::ofstream{folder_ / "car.toml", std::ios::app}
      << "[record]\nvehicle = \"4711\"\ntruck = \"front\"\n[model]\nvelocity_corner_hz = 0.7\n"
         "[spool]\nfolder = \"disk/spool\"\nsegment_s = 20.0\nevery_s = 3.0\n"
         "reserve_free_mib = 0\n";
  LiveProgram live{folder_, bus_.name(), folder_ / "run", options()};
  Child sender = send(80.0);
  std::this_thread::sleep_for(seconds{30});
  const std::uint64_t before = samples_in(folder_ / "disk/spool");
  EXPECT_GT(before, 2U * 300U);  // samples wait 24 s for the guards, a state 3 s
  disk.fill();
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  now.tv_sec += 3600;
  ::clock_settime(CLOCK_REALTIME, &now);
  std::this_thread::sleep_for(seconds{25});
  EXPECT_THAT(read_file(live.run() / "live.json"), HasSubstr("[spool]"));
  EXPECT_EQ(samples_in(folder_ / "disk/spool"), before) << "what was there stays whole";
  disk.empty();
  ASSERT_EQ(sender.wait().status, 0);
  std::this_thread::sleep_for(seconds{1});
  const nlohmann::json all = live.stop();
  EXPECT_EQ(samples_in(folder_ / "disk/spool"), all.at("counts").at("samples"));
  EXPECT_EQ(all.at("counts").at("samples"), 80 * 300);
}

TEST_F(TimeTravelNightlyDisk, RemovedRunDirectoryIsMadeAgain) {
  const fs::path run = folder_ / "run";
  LiveProgram live{folder_, bus_.name(), run, options()};
  Child sender = send(40.0);
  std::this_thread::sleep_for(seconds{15});
  fs::remove_all(run);
  ASSERT_EQ(sender.wait().status, 0);
  std::this_thread::sleep_for(seconds{1});
  EXPECT_TRUE(fs::exists(run / "live.json"));
  const nlohmann::json all = live.stop();
  EXPECT_NEAR(value_of(all, "coulomb"), 8350.0, 400.0);
  EXPECT_FALSE(fs::is_empty(run / "blackbox")) << "the recording goes on in a new directory";
  EXPECT_GT(all.at("live").at("records_lost").get<int>(), 0);
}

TEST_F(TimeTravelNightlyDisk, ReadOnlyAtTheEndIsWaitedFor) {
  const Disk disk{folder_ / "disk"};
  Child live{command(folder_ / "disk/run"), folder_.path()};
  std::this_thread::sleep_for(seconds{1});
  ASSERT_EQ(send(40.0).wait().status, 0);
  disk.read_only(true);
  std::this_thread::sleep_for(seconds{2});
  live.signal(SIGTERM);
  std::this_thread::sleep_for(seconds{4});
  ASSERT_TRUE(live.running()) << live.error();
  disk.read_only(false);
  const Ended ended = live.wait(std::chrono::minutes{1});
  EXPECT_EQ(ended.status, 0) << ended.error;
  EXPECT_TRUE(fs::exists(folder_ / "disk/run/state.dls"));
}

TEST_F(TimeTravelNightlyDisk, ReadOnlyForGoodSendsTheResultElsewhere) {
  const Disk disk{folder_ / "disk"};
  fs::create_directories(folder_ / "refuge");
  ::setenv("RUNTIME_DIRECTORY", (folder_ / "refuge").c_str(), 1);
  Child live{command(folder_ / "disk/run"), folder_.path()};
  ::unsetenv("RUNTIME_DIRECTORY");
  std::this_thread::sleep_for(seconds{1});
  ASSERT_EQ(send(40.0).wait().status, 0);
  disk.read_only(true);
  live.signal(SIGTERM);
  const Ended ended = live.wait(std::chrono::minutes{2});
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.error, HasSubstr("Read-only file system"));
  const fs::path refuge = folder_ / "refuge/dampline-run.run";
  EXPECT_THAT(ended.error, HasSubstr("the run was put into " + refuge.string()));
  EXPECT_NEAR(value_of(read_parameters(refuge), "coulomb"), 8350.0, 400.0);
  EXPECT_TRUE(fs::exists(refuge / "state.dls"));
}

}  // namespace
}  // namespace dampline::bus
