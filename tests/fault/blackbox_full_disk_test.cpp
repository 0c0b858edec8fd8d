// SPDX-License-Identifier: MIT
// The black box on a file system that is really full.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <unistd.h>

#include <cerrno>
#include <vector>

#include "tests/blackbox.hpp"

namespace dampline::fault {
namespace {

using hal::EventKind;
using test::BoxContent;
using test::BoxFolder;
using test::kSecondNs;
using test::numbered_frame;

constexpr std::size_t kBallast = std::size_t{3} << 20U;

/// A file system of 4 MiB, 3 of them taken; of this process only.
class SmallDisk {
 public:
  SmallDisk() {
    std::filesystem::create_directories(folder_.path());
    mounted_ = ::unshare(CLONE_NEWNS) == 0 &&
               ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
               ::mount("tmpfs", folder_.path().c_str(), "tmpfs", 0, "size=4m") == 0;
    if (mounted_) test::write_bytes(ballast(), std::string(kBallast, 'x'));
  }
  ~SmallDisk() {
    if (mounted_) ::umount2(folder_.path().c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  [[nodiscard]] bool mounted() const { return mounted_; }
  [[nodiscard]] std::filesystem::path box() const { return folder_.path() / "box"; }
  void make_room() const { std::filesystem::remove(ballast()); }
  [[nodiscard]] std::uint64_t free_bytes() const {
    return std::filesystem::space(folder_.path()).available;
  }

 private:
  [[nodiscard]] std::filesystem::path ballast() const { return folder_.path() / "ballast"; }
  BoxFolder folder_;
  bool mounted_{false};
};

/// Second by second, a thousand frames each.
class SteadyWriter {
 public:
  explicit SteadyWriter(const drivers::BlackboxConfig& config) : writer_{test::open_box(config)} {
    writer_->tick(0);
  }
  void seconds(int count) {
    for (int s = 0; s < count; ++s) {
      for (int i = 0; i < 1000; ++i) writer_->write(numbered_frame(next_++));
      writer_->tick(++now_s_ * kSecondNs);
    }
  }
  drivers::BlackboxWriter& operator*() { return *writer_; }
  [[nodiscard]] std::uint64_t frames() const { return next_; }

 private:
  std::unique_ptr<drivers::BlackboxWriter> writer_;
  std::uint64_t next_{0};
  std::int64_t now_s_{0};
};

void check_accounts(const BoxContent& content, SteadyWriter& writer) {
  const hal::RecordHealth health = (*writer).health();
  EXPECT_TRUE(content.all_true());
  EXPECT_EQ(content.health.malformed, 0U);
  EXPECT_EQ(content.frames.size() + health.lost, writer.frames());
  EXPECT_EQ(content.health.dropped, health.lost);
  const auto resumed = content.of(EventKind::kRecordingResumed);
  ASSERT_EQ(resumed.size(), 1U);
  EXPECT_EQ(static_cast<std::uint64_t>(resumed[0].value), health.lost);
  EXPECT_EQ(content.of(EventKind::kRecordingStopped).at(0).value, ENOSPC);
}

TEST(BlackboxFullDisk, StopsRecordingAndGoesOnWhenThereIsSpace) {
  const SmallDisk disk;
  if (!disk.mounted()) GTEST_SKIP() << "a file system cannot be mounted here";
  SteadyWriter writer{test::box_config(disk.box())};
  writer.seconds(60);
  EXPECT_FALSE((*writer).health().recording);
  EXPECT_EQ((*writer).health().last_errno, ENOSPC);
  EXPECT_LT(disk.free_bytes(), 64U << 10U);
  const auto full = test::read_box(disk.box());
  EXPECT_EQ(full.numbers(), test::range(0, full.frames.size()));
  EXPECT_FALSE(full.health.truncated);  // whole records only
  disk.make_room();
  writer.seconds(10);
  EXPECT_TRUE((*writer).health().recording);
  (*writer).close();
  const auto content = test::read_box(disk.box());
  EXPECT_EQ(content.numbers().back(), writer.frames() - 1);
  check_accounts(content, writer);
}

TEST(BlackboxFullDisk, LeavesTheReserveFree) {
  const SmallDisk disk;
  if (!disk.mounted()) GTEST_SKIP() << "a file system cannot be mounted here";
  auto config = test::box_config(disk.box());
  config.reserve_free_bytes = 512U << 10U;
  SteadyWriter writer{config};
  writer.seconds(60);
  EXPECT_FALSE((*writer).health().recording);
  EXPECT_GT(disk.free_bytes(), 400U << 10U);
  disk.make_room();
  writer.seconds(10);
  (*writer).close();
  check_accounts(test::read_box(disk.box()), writer);
}

TEST(BlackboxFullDisk, MakesRoomItselfWhereItMay) {
  const SmallDisk disk;
  if (!disk.mounted()) GTEST_SKIP() << "a file system cannot be mounted here";
  auto config = test::box_config(disk.box());
  config.rotate_bytes = 100'000;
  config.keep_bytes = 600'000;
  SteadyWriter writer{config};
  writer.seconds(200);
  (*writer).close();
  EXPECT_EQ((*writer).health().lost, 0U);
  EXPECT_EQ(test::read_box(disk.box()).numbers().back(), writer.frames() - 1);
}

}  // namespace
}  // namespace dampline::fault
