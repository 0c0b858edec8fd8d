// SPDX-License-Identifier: MIT
// The installed service under a systemd of its own, from boot to boot.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>

#include "sim_hw/simulation.hpp"
#include "tests/bus/bus.hpp"
#include "tests/bus/child.hpp"
#include "tests/bus/live_program.hpp"
#include "tests/bus/sensors.hpp"

namespace dampline::bus {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;
using testing::HasSubstr;
using testing::StartsWith;

const std::string kSystem = DAMPLINE_SOURCE_DIR "/tests/bus/system";

void set_clock(std::int64_t time_s) {
  const timespec time{.tv_sec = static_cast<time_t>(time_s), .tv_nsec = 0};
  ASSERT_EQ(::clock_settime(CLOCK_REALTIME, &time), 0);
}

/// The system, its service enabled for a bus with three sensors.
class TimeTravelNightlySystemd : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists("/lib/systemd/systemd")) GTEST_SKIP() << "systemd is not installed";
    run({kSystem, "prepare", folder_.path(), DAMPLINE_BINARY_DIR});
    configure("");
    const fs::path wanted = root_ / "etc/systemd/system/multi-user.target.wants";
    fs::create_directories(wanted);
    fs::create_symlink("/usr/local/lib/systemd/system/dampline@.service", wanted / unit());
    sensors_.motion = [this] { return simulation_.next().counts; };
    sensors_.batch = 4;
  }
  /// The sample of the configuration that comes with the service, and this.
  void configure(const std::string& more) const {
    const std::string sample = read_file(DAMPLINE_SOURCE_DIR "/app/service/can0.toml");
    std::ofstream{root_ / "etc/dampline" / (bus_.name() + ".toml")} << sample << more;
  }
  void boot() {
    fs::remove(folder_ / "pid");
    system_.emplace(std::vector<std::string>{kSystem, "boot", folder_.path()}, folder_.path());
  }
  /// Every process of it ends at once.
  void cut_power() { system_.reset(); }

  [[nodiscard]] std::string unit() const { return "dampline@" + bus_.name() + ".service"; }
  [[nodiscard]] fs::path state() const { return root_ / "var/lib/dampline"; }
  [[nodiscard]] fs::path blackbox() const { return state() / (bus_.name() + ".blackbox"); }
  [[nodiscard]] std::string pid() const {
    std::string text = read_file(folder_ / "pid");
    return text.substr(0, text.find('\n'));
  }
  /// A command within the system. Its output, whatever its status.
  std::string within(const Words& command) const {
    Words words{"nsenter", "-t", pid(), "-m", "-p", "-u", "-i", "-r", "-w"};
    words.insert(words.end(), command.begin(), command.end());
    return Child{words, folder_.path()}.wait(std::chrono::minutes{2}).output;
  }
  [[nodiscard]] std::string property(const std::string& name) const {
    std::string value = within({"systemctl", "show", unit(), "--value", "-p", name});
    return value.substr(0, value.find('\n'));
  }
  /// Waits until a property of the unit is this.
  [[nodiscard]] bool becomes(const std::string& name, const std::string& value,
                             seconds limit = seconds{150}) const {
    constexpr seconds kPause{10};
    for (seconds waited{0}; waited < limit; waited += kPause) {
      std::this_thread::sleep_for(kPause);
      if (property(name) == value) return true;
    }
    return false;
  }
  /// Everything that the recordings hold, as frames.
  [[nodiscard]] std::uint64_t recorded() const {
    const fs::path log = folder_ / "all.log";
    const Words command{
        DAMPLINE_BINARY_DIR "/dampline", "export", blackbox(), "--out", log, "--force"};
    const Ended read = Child{command, folder_.path()}.wait();
    EXPECT_EQ(read.status, 0) << read.error;
    EXPECT_THAT(read.error, HasSubstr(" 0 damaged stretches"));
    const std::string text = read_file(log);
    return static_cast<std::uint64_t>(std::count(text.begin(), text.end(), '\n'));
  }
  [[nodiscard]] std::size_t recordings() const {
    const fs::directory_iterator files{blackbox()};
    return static_cast<std::size_t>(std::count_if(begin(files), end(files), [](const auto& file) {
      return file.path().extension() == ".dbb";
    }));
  }
  /// What was being written when a run was killed.
  [[nodiscard]] std::ptrdiff_t left_over() const {
    const fs::directory_iterator files{state()};
    return std::count_if(begin(files), end(files), [](const auto& file) {
      return file.path().filename().string().starts_with(".");
    });
  }
  void drive(double time_s) { sensors_.run(std::chrono::duration<double>{time_s}); }

  const Folder folder_;
  const fs::path root_{folder_ / "root"};
  const VirtualCan bus_;
  RawSender wire_{bus_.name()};
  Sensors sensors_{wire_};
  sim::Simulation simulation_{sim::reference_run(sim::Load::kLaden, 80.0, 7)};
  std::optional<Child> system_;
};

TEST_F(TimeTravelNightlySystemd, FromBootToStopEveryFrameIsThere) {
  boot();
  ASSERT_TRUE(becomes("ActiveState", "active")) << within({"systemctl", "status", unit()});
  drive(70.0);
  EXPECT_THAT(property("StatusText"), HasSubstr("coulomb"));
  EXPECT_THAT(within({"stat", "-c", "%U:%G %a", "/run/dampline/" + bus_.name() + "/live.json"}),
              "dampline:dampline 640\n");
  EXPECT_THAT(within({"ps", "-o", "user=", "-p", property("MainPID")}), "dampline\n");
  EXPECT_EQ(recordings(), 1U);
  within({"systemctl", "reload", unit()});
  drive(2.0);
  EXPECT_EQ(recordings(), 2U);
  within({"systemctl", "stop", unit()});
  EXPECT_EQ(property("Result"), "success");
  const fs::path run = state() / (bus_.name() + ".run");
  const nlohmann::json counts = read_parameters(run).at("counts");
  EXPECT_EQ(counts.at("frames_sent"), sensors_.made());
  EXPECT_EQ(counts.at("frames_processed"), sensors_.made());
  EXPECT_TRUE(fs::exists(run / "report.html"));
  EXPECT_EQ(recorded(), sensors_.made());
  EXPECT_EQ(within({"journalctl", "-q", "-p", "warning", "-u", unit()}), "");
}

TEST_F(TimeTravelNightlySystemd, ItBeginsAnewWhenKilledAndWhenItHangs) {
  boot();
  ASSERT_TRUE(becomes("ActiveState", "active"));
  drive(5.0);
  std::uint64_t kept = sensors_.made() - 3 * Sensors::kRateHz;
  for (const std::string killer : {"KILL", "STOP", "SEGV"}) {
    const std::string before = property("NRestarts");
    within({"kill", "-" + killer, property("MainPID")});
    // The watchdog's 20 s, and up to 90 s for one that does not end; 10 s between two starts.
    ASSERT_TRUE(becomes("NRestarts", std::to_string(std::stoi(before) + 1))) << killer;
    ASSERT_TRUE(becomes("ActiveState", "active")) << killer;
    const std::uint64_t made = sensors_.made();
    drive(5.0);
    kept += sensors_.made() - made - 3 * Sensors::kRateHz;
  }
  for (int i = 0; i < 12; ++i) {  // more than StartLimitBurst=
    within({"kill", "-KILL", property("MainPID")});
    std::this_thread::sleep_for(seconds{12});
    ASSERT_EQ(property("ActiveState"), "active") << i;
  }
  within({"systemctl", "stop", unit()});
  EXPECT_EQ(left_over(), 0);
  EXPECT_GE(recorded(), kept);
  EXPECT_LE(recorded(), sensors_.made());
}

TEST_F(TimeTravelNightlySystemd, AWrongConfigurationIsSaidOnce) {
  configure("[estimat]\n");
  boot();
  ASSERT_TRUE(becomes("ActiveState", "failed"));
  EXPECT_EQ(property("ExecMainStatus"), "2");
  std::this_thread::sleep_for(seconds{60});
  EXPECT_EQ(property("NRestarts"), "0");
  const std::string journal = within({"journalctl", "-q", "-u", unit()});
  EXPECT_THAT(journal, HasSubstr(bus_.name() + ".toml"));
  EXPECT_THAT(journal, HasSubstr("estimat"));
  configure("");
  within({"systemctl", "start", unit()});
  EXPECT_EQ(property("ActiveState"), "active");
}

// Each boot begins in 1970, and the power goes before the time is there; but for the last.
TEST_F(TimeTravelNightlySystemd, ALoopOfBootsWithoutAClockKeepsItsRecording) {
  constexpr int kBoots = 5;
  constexpr std::uint64_t kUnsynced = 2 * 3 * Sensors::kRateHz;  // frames of two seconds
  timespec before{};
  ::clock_gettime(CLOCK_REALTIME, &before);
  for (int boots = 1; boots <= kBoots; ++boots) {
    set_clock(86'400);  // not before the machine began
    boot();
    ASSERT_TRUE(becomes("ActiveState", "active")) << boots;
    drive(10.0);
    if (boots < kBoots) cut_power();
  }
  set_clock(before.tv_sec);
  drive(10.0);
  within({"systemctl", "stop", unit()});
  const fs::path run = state() / (bus_.name() + ".run." + std::to_string(kBoots));
  const nlohmann::json counts = read_parameters(run).at("counts");
  EXPECT_EQ(counts.at("frames_sent"), 2 * 3 * 10 * Sensors::kRateHz);
  EXPECT_EQ(counts.at("frames_processed"), counts.at("frames_sent"));
  EXPECT_EQ(left_over(), 0);
  EXPECT_LE(recorded(), sensors_.made());
  EXPECT_GE(recorded() + (kBoots - 1) * kUnsynced, sensors_.made());
}

TEST_F(TimeTravelNightlySystemd, WithoutABusItTriesAgainUntilThereIsOne) {
  bus_.down();
  run({"ip", "link", "set", bus_.name(), "name", "away0"});
  boot();
  ASSERT_TRUE(becomes("NRestarts", "2", seconds{200}));
  run({"ip", "link", "set", "away0", "name", bus_.name()});
  bus_.up();
  ASSERT_TRUE(becomes("ActiveState", "active", seconds{20}));
  drive(3.0);
  within({"systemctl", "stop", unit()});
  EXPECT_EQ(recorded() + sensors_.refused(), sensors_.made());
  const std::string journal = within({"journalctl", "-q", "-u", unit()});
  EXPECT_THAT(journal, HasSubstr("no such CAN interface"));
  EXPECT_THAT(journal, HasSubstr("nothing could be identified"));
}

}  // namespace
}  // namespace dampline::bus
