// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "app/live/process.hpp"

namespace dampline::app {
namespace {

/// The manager's end.
class Manager {
 public:
  explicit Manager(std::string name) : name_{std::move(name)} {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::copy(name_.begin(), name_.end(), std::begin(address.sun_path));
    if (name_[0] == '@') address.sun_path[0] = '\0';
    file_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0);
    const auto bytes = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name_.size());
    EXPECT_EQ(::bind(file_, reinterpret_cast<const sockaddr*>(&address), bytes), 0);
  }
  Manager(const Manager&) = delete;
  Manager& operator=(const Manager&) = delete;
  ~Manager() {
    ::close(file_);
    if (name_[0] == '/') std::filesystem::remove(name_);
  }
  /// All that was said since the last call.
  [[nodiscard]] std::vector<std::string> heard() const {
    std::vector<std::string> all;
    std::array<char, 4096> text{};
    for (ssize_t bytes = 0; (bytes = ::recv(file_, text.data(), text.size(), 0)) >= 0;) {
      all.emplace_back(text.data(), static_cast<std::size_t>(bytes));
    }
    return all;
  }

 private:
  std::string name_;
  int file_{-1};
};

std::string socket_path() {
  return testing::TempDir() + "dampline_notify_" + std::to_string(::getpid());
}

using Lines = std::vector<std::string>;

TEST(Notifier, SpeaksTheManagersProtocol) {
  for (const std::string& name :
       {socket_path(), "@dampline_notify_" + std::to_string(::getpid())}) {
    const Manager manager{name};
    Notifier notifier{name};
    ASSERT_TRUE(notifier.active());
    notifier.ready("waiting for can0");
    notifier.watchdog();
    notifier.reloading();
    notifier.stopping();
    EXPECT_EQ(manager.heard(), (Lines{"READY=1", "STATUS=waiting for can0", "WATCHDOG=1",
                                      "RELOADING=1", "STOPPING=1"}));
    EXPECT_EQ(notifier.failures(), 0U);
  }
}

TEST(Notifier, KeepsAStatusToOneShortLine) {
  const Manager manager{socket_path()};
  Notifier notifier{socket_path()};
  notifier.status("one\nREADY=1");
  notifier.status(std::string(5000, 'x'));
  const Lines heard = manager.heard();
  ASSERT_EQ(heard.size(), 2U);
  EXPECT_EQ(heard[0], "STATUS=one");
  EXPECT_EQ(heard[1], "STATUS=" + std::string(505, 'x'));
}

TEST(Notifier, IsSilentWithoutAManager) {
  for (const std::string name : {"", "/", "vsock:2:1234", "relative"}) {
    Notifier notifier{name};
    notifier.ready("");
    EXPECT_FALSE(notifier.active()) << name;
    EXPECT_EQ(notifier.failures(), 0U);
  }
  EXPECT_FALSE(Notifier{"/" + std::string(200, 'x')}.active());
}

TEST(Notifier, CountsWhatNobodyHears) {
  Notifier notifier{socket_path() + "_nobody"};
  notifier.ready("x");
  EXPECT_EQ(notifier.failures(), 2U);
}

TEST(Notifier, WaitsOnlyShortlyForAManagerThatDoesNotListen) {
  const Manager manager{socket_path()};
  Notifier notifier{socket_path()};
  for (int i = 0; i < 1000 && notifier.failures() == 0; ++i) notifier.watchdog();
  EXPECT_EQ(notifier.failures(), 1U);
  EXPECT_FALSE(manager.heard().empty());
  notifier.stopping();
  EXPECT_EQ(manager.heard(), Lines{"STOPPING=1"});
}

TEST(NotifyEnvironment, TakesTheVariablesOut) {
  ::setenv("NOTIFY_SOCKET", "/run/x", 1);
  ::setenv("WATCHDOG_USEC", "20000000", 1);
  ::setenv("WATCHDOG_PID", std::to_string(::getpid()).c_str(), 1);
  const NotifyEnvironment environment = NotifyEnvironment::take();
  EXPECT_EQ(environment.socket, "/run/x");
  EXPECT_EQ(environment.watchdog_ns, 20'000'000'000);
  EXPECT_EQ(std::getenv("NOTIFY_SOCKET"), nullptr);
  EXPECT_EQ(std::getenv("WATCHDOG_USEC"), nullptr);
  EXPECT_EQ(std::getenv("WATCHDOG_PID"), nullptr);
}

TEST(NotifyEnvironment, LeavesAWatchdogToWhomItIsMeantFor) {
  ::setenv("WATCHDOG_USEC", "20000000", 1);
  ::setenv("WATCHDOG_PID", "1", 1);
  EXPECT_FALSE(NotifyEnvironment::take().watchdog_ns);
  for (const char* nonsense : {"", "0", "-5", "12x", "99999999999999999999"}) {
    ::setenv("WATCHDOG_USEC", nonsense, 1);
    EXPECT_FALSE(NotifyEnvironment::take().watchdog_ns) << nonsense;
  }
  ::setenv("WATCHDOG_USEC", "1000", 1);
  EXPECT_EQ(NotifyEnvironment::take().watchdog_ns, 1'000'000);
}

TEST(Watchdog, IsFedWhileTheLoopComesRound) {
  const Manager manager{socket_path()};
  Notifier notifier{socket_path()};
  Watchdog watchdog{notifier, 2'000'000'000};
  for (std::uint64_t i = 1; i <= 100; ++i) {  // 10 s, a turn every 0.1 s
    const std::uint64_t before = watchdog.feeds();
    watchdog.look(i, static_cast<std::int64_t>(i) * 100'000'000);
    EXPECT_EQ(manager.heard(), Lines(watchdog.feeds() - before, "WATCHDOG=1"));
  }
  EXPECT_EQ(watchdog.feeds(), 20U);  // four times in each timeout
}

TEST(Watchdog, StarvesWhenTheLoopHangs) {
  const Manager manager{socket_path()};
  Notifier notifier{socket_path()};
  Watchdog watchdog{notifier, 2'000'000'000};
  watchdog.look(7, 1'000'000'000);
  for (std::int64_t i = 2; i < 100; ++i) watchdog.look(7, i * 1'000'000'000);
  EXPECT_EQ(watchdog.feeds(), 1U);
  watchdog.look(8, 100'000'000'000);
  EXPECT_EQ(watchdog.feeds(), 2U);
}

TEST(Watchdog, SaysNothingWhereNobodyWatches) {
  const Manager manager{socket_path()};
  Notifier notifier{socket_path()};
  Watchdog watchdog{notifier, std::nullopt};
  watchdog.look(1, 1'000'000'000);
  EXPECT_TRUE(manager.heard().empty());
}

}  // namespace
}  // namespace dampline::app
