// SPDX-License-Identifier: MIT
// kill -9 at 200 random moments of a program that writes.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstring>
#include <map>
#include <random>

#include "tests/blackbox.hpp"

extern char** environ;

namespace dampline::fault {
namespace {

using test::BoxContent;
using test::BoxFolder;
using test::number_of;

constexpr int kKillsInEach = 10;
constexpr std::uint64_t kApart = 10'000'000;  // between the first frames of two starts

/// One start of the probe, up to its violent end.
class Victim {
 public:
  Victim(const std::filesystem::path& folder, std::uint64_t first) {
    std::array<int, 2> ends{};
    EXPECT_EQ(::pipe2(ends.data(), O_CLOEXEC), 0);
    reports_ = ends[0];
    posix_spawn_file_actions_t actions{};
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    std::string program = DAMPLINE_BLACKBOX_PROBE;
    std::string where = folder.string();
    std::string number = std::to_string(first);
    std::array<char*, 4> arguments{program.data(), where.data(), number.data(), nullptr};
    EXPECT_EQ(
        ::posix_spawn(&process_, program.c_str(), &actions, nullptr, arguments.data(), environ), 0);
    ::posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
  }
  ~Victim() { ::close(reports_); }
  Victim(const Victim&) = delete;
  Victim& operator=(const Victim&) = delete;

  void wait_for_first_report() { static_cast<void>(take_report()); }
  /// Kills it; gives how many frames it had reported as safe.
  std::uint64_t kill() {
    EXPECT_EQ(::kill(process_, SIGKILL), 0);
    int status = 0;
    EXPECT_EQ(::waitpid(process_, &status, 0), process_);
    EXPECT_TRUE(WIFSIGNALED(status)) << "ended by itself with " << WEXITSTATUS(status);
    while (take_report()) {
    }
    return synced_;
  }

 private:
  bool take_report() {
    std::array<char, 8> bytes{};
    if (::read(reports_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size()))
      return false;
    std::memcpy(&synced_, bytes.data(), bytes.size());
    return true;
  }
  pid_t process_{-1};
  int reports_{-1};
  std::uint64_t synced_{0};
};

std::map<std::string, std::uint64_t> sizes(const BoxFolder& folder) {
  std::map<std::string, std::uint64_t> all;
  std::error_code error;
  for (const auto& file : drivers::list_blackbox(folder.path(), error))
    all[file.path.string()] = file.bytes;
  return all;
}

/// The frames of each start are its first ones, to the last that was safe at least.
void check(const BoxContent& content, const std::vector<std::uint64_t>& safe) {
  ASSERT_TRUE(content.all_true());
  ASSERT_EQ(content.health.malformed, 0U);
  ASSERT_EQ(content.health.dropped, 0U);
  std::size_t at = 0;
  for (std::size_t start = 0; start < safe.size(); ++start) {
    std::uint64_t count = 0;
    while (at < content.frames.size() && number_of(content.frames[at]) == start * kApart + count) {
      ++at;
      ++count;
    }
    ASSERT_GE(count, safe[start]) << "start " << start;
  }
  ASSERT_EQ(at, content.frames.size());
}

void kill_at_random_moments(int folders, std::uint64_t least_safe) {
  std::mt19937 random{20};
  std::uniform_int_distribution<useconds_t> moment_us{0, 12'000};
  std::uint64_t all_safe = 0;
  for (int f = 0; f < folders; ++f) {
    const BoxFolder folder;
    std::vector<std::uint64_t> safe;
    for (int k = 0; k < kKillsInEach; ++k) {
      const auto before = sizes(folder);
      Victim victim{folder.path(), safe.size() * kApart};
      if (k % 4 != 3) victim.wait_for_first_report();  // the fourth dies while it starts
      ::usleep(moment_us(random));
      safe.push_back(victim.kill());
      all_safe += safe.back();
      const auto after = sizes(folder);
      for (const auto& [name, bytes] : before) ASSERT_EQ(after.at(name), bytes) << name;
      if (safe.back() > 0) {
        ASSERT_GT(after.size(), before.size());
      }
      const BoxContent content = test::read_box(folder.path(), 4096);
      if (!content.opened) {
        ASSERT_EQ(all_safe, 0U) << content.error;
        continue;
      }
      check(content, safe);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
  EXPECT_GT(all_safe, least_safe);
}

TEST(BlackboxKill, AtRandomMomentsLosesNothingThatWasSyncedAndInventsNothing) {
  kill_at_random_moments(3, 15'000U);
}

TEST(BlackboxKillNightly, At200RandomMomentsLosesNothingThatWasSyncedAndInventsNothing) {
  kill_at_random_moments(20, 100'000U);
}

}  // namespace
}  // namespace dampline::fault
