// SPDX-License-Identifier: MIT
// The program as a service sees it: lamp, GPIO edges, signals, and words to the manager.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/bus/bus.hpp"
#include "tests/bus/child.hpp"
#include "tests/bus/gpio_sim.hpp"

namespace dampline::bus {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using std::chrono::steady_clock;

const std::string kProgram = DAMPLINE_BINARY_DIR "/dampline";

/// What a person sees of a lamp in 4 s.
struct Look {
  bool always_lit{true};
  int changes{0};
};

Look look_at(const GpioSim& gpio, unsigned line) {
  Look look;
  bool before = gpio.high(line);
  for (const auto end = steady_clock::now() + seconds{4}; steady_clock::now() < end;) {
    std::this_thread::sleep_for(milliseconds{25});
    const bool now = gpio.high(line);
    look.always_lit = look.always_lit && now;
    look.changes += now != before ? 1 : 0;
    before = now;
  }
  return look;
}

bool slow(const Look& look) { return look.changes >= 3 && look.changes <= 5; }
bool quick(const Look& look) { return look.changes >= 20 && look.changes <= 36; }

/// A live run with a lamp at line 7 and a marker at line 3.
class LiveRun {
 public:
  LiveRun() {
    std::ofstream{folder / "car.toml"} << "[gpio]\nchip = \"" << gpio.chip()
                                       << "\"\nedges = [\"marker:3\"]\nlamp = \"7\"\n";
  }
  [[nodiscard]] std::vector<std::string> command() const {
    return {kProgram,   "identify",          bus.name(),
            "--config", folder / "car.toml", "--out",
            run(),      "--no-report",       "--realtime-priority",
            "0"};
  }
  [[nodiscard]] std::string run() const { return folder / "run"; }
  [[nodiscard]] std::string text(const std::string& file) const {
    return read_file(std::filesystem::path{run()} / file);
  }

  const Folder folder;
  const VirtualCan bus;
  const GpioSim gpio;
};

TEST(TimeTravelService, LampAndMarkersFollowTheRun) {
  const LiveRun live;
  Child program{live.command(), live.folder.path()};
  std::this_thread::sleep_for(seconds{2});
  EXPECT_TRUE(slow(look_at(live.gpio, 7))) << "waiting for a signal";
  {
    Child sender{{kProgram, "simulate", "--to", live.bus.name(), "--duration", "25", "--quiet"},
                 live.folder.path()};
    std::this_thread::sleep_for(seconds{12});
    EXPECT_TRUE(look_at(live.gpio, 7).always_lit) << "identifying";
    live.gpio.move(3, true);
    live.gpio.move(3, false);
    EXPECT_EQ(sender.wait().status, 0) << sender.error();
  }
  std::this_thread::sleep_for(seconds{2});
  EXPECT_TRUE(slow(look_at(live.gpio, 7))) << "the signal is lost";
  std::this_thread::sleep_for(seconds{10});
  const Look fault = look_at(live.gpio, 7);
  EXPECT_TRUE(quick(fault)) << "no signal for long; changes " << fault.changes;
  program.signal(SIGTERM);
  const Ended ended = program.wait(seconds{60});
  EXPECT_EQ(ended.status, 0) << ended.error;
  EXPECT_FALSE(live.gpio.high(7)) << "dark at the end";
  const std::string events = live.text("events.csv");
  EXPECT_NE(events.find("marker"), std::string::npos) << events;
  EXPECT_NE(live.text("parameters.json").find("\"coulomb\""), std::string::npos);
}

/// The service manager's socket.
class Manager {
 public:
  explicit Manager(const std::string& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::copy(path.begin(), path.end(), std::begin(address.sun_path));
    file_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    EXPECT_EQ(::bind(file_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  Manager(const Manager&) = delete;
  Manager& operator=(const Manager&) = delete;
  ~Manager() { ::close(file_); }
  /// Listens for that long, or until the word came so often; how often it did.
  std::size_t hears(const std::string& word, seconds time, std::size_t enough = 1'000) {
    std::size_t count = 0;
    const auto end = steady_clock::now() + time;
    while (count < enough && steady_clock::now() < end) {
      std::this_thread::sleep_for(milliseconds{10});
      std::array<char, 1024> text{};
      for (ssize_t bytes = 0; (bytes = ::recv(file_, text.data(), text.size(), 0)) > 0;) {
        const std::string message(text.data(), static_cast<std::size_t>(bytes));
        if (message.starts_with(word)) ++count;
      }
    }
    return count;
  }

 private:
  int file_{-1};
};

std::vector<std::string> under_manager(const LiveRun& live, const std::string& socket) {
  std::vector<std::string> all{"env", "NOTIFY_SOCKET=" + socket, "WATCHDOG_USEC=2000000"};
  for (const std::string& word : live.command()) all.push_back(word);
  return all;
}

TEST(TimeTravelNightlyService, TellsItsManager) {
  const LiveRun live;
  const std::string socket = live.folder / "manager";
  Manager manager{socket};
  Child program{under_manager(live, socket), live.folder.path()};
  EXPECT_EQ(manager.hears("READY=1", seconds{20}, 1), 1U);
  // A quarter of 2 s, with no frame at all: a lost signal is waited out.
  const std::size_t fed = manager.hears("WATCHDOG=1", seconds{5});
  EXPECT_GE(fed, 6U);
  EXPECT_LE(fed, 11U);
  program.signal(SIGHUP);
  EXPECT_EQ(manager.hears("RELOADING=1", seconds{10}, 1), 1U);
  // A program that stands still does not feed: the manager would start it anew.
  program.signal(SIGSTOP);
  static_cast<void>(manager.hears("WATCHDOG=1", seconds{1}));
  EXPECT_EQ(manager.hears("WATCHDOG=1", seconds{4}), 0U);
  program.signal(SIGCONT);
  EXPECT_GE(manager.hears("WATCHDOG=1", seconds{4}), 3U);
  Child sender{{kProgram, "simulate", "--to", live.bus.name(), "--duration", "22", "--quiet"},
               live.folder.path()};
  EXPECT_GE(manager.hears("STATUS=", seconds{25}), 2U);
  program.signal(SIGTERM);
  EXPECT_EQ(manager.hears("STOPPING=1", seconds{10}, 1), 1U);
  EXPECT_EQ(program.wait(seconds{60}).status, 0) << program.error();
}

}  // namespace
}  // namespace dampline::bus
