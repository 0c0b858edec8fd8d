// SPDX-License-Identifier: MIT
#include "tests/fault/fault_plan.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <string_view>

namespace dampline::fault {
namespace {

/// write() of one byte to /dev/null: what came back, and errno where it failed.
int write_one() {
  const int file = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  const auto written = ::write(file, "x", 1);
  const int error = errno;
  ::close(file);
  return written == 1 ? 0 : error;
}

TEST(FaultPlan, LeavesEveryCallAloneWhenNothingIsArmed) {
  EXPECT_EQ(write_one(), 0);
  const ArmedFault other{{.call = Call::kFsync}};
  EXPECT_EQ(write_one(), 0);
  EXPECT_EQ(other.calls(), 0U);
}

TEST(FaultPlan, FailsTheNthCallOnce) {
  const ArmedFault fault{{.call = Call::kWrite, .nth = 2, .error = ENOSPC}};
  EXPECT_EQ(write_one(), 0);
  EXPECT_EQ(write_one(), ENOSPC);
  EXPECT_EQ(write_one(), 0);
  EXPECT_EQ(fault.calls(), 3U);
  EXPECT_EQ(fault.fired(), 1U);
}

TEST(FaultPlan, FailsFromTheNthCallOn) {
  {
    const ArmedFault fault{{.call = Call::kWrite, .nth = 2, .for_ever = true}};
    EXPECT_EQ(write_one(), 0);
    EXPECT_EQ(write_one(), EIO);
    EXPECT_EQ(write_one(), EIO);
    EXPECT_EQ(fault.fired(), 2U);
  }
  EXPECT_EQ(write_one(), 0);
}

TEST(FaultPlan, CutsAWriteShort) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const ArmedFault fault{{.call = Call::kWrite, .nth = 1, .error = kShort}};
  EXPECT_EQ(::write(ends[1], "abcdef", 6), 3);
  EXPECT_EQ(::write(ends[1], "def", 3), 3);
  std::array<char, 8> got{};
  EXPECT_EQ(::read(ends[0], got.data(), got.size()), 6);
  EXPECT_EQ(std::string_view{got.data()}, "abcdef");
  ::close(ends[0]);
  ::close(ends[1]);
}

TEST(FaultPlan, ReachesTheOtherKinds) {
  const ArmedFault open_fault{{.call = Call::kOpen, .error = EMFILE}};
  EXPECT_EQ(::open("/dev/null", O_RDONLY | O_CLOEXEC), -1);
  EXPECT_EQ(errno, EMFILE);
  const ArmedFault map_fault{{.call = Call::kMmap, .error = ENOMEM}};
  EXPECT_EQ(::mmap(nullptr, 4096, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0), MAP_FAILED);
  const ArmedFault lock_fault{{.call = Call::kMlockall, .error = EPERM}};
  EXPECT_EQ(::mlockall(0), -1);
  EXPECT_EQ(errno, EPERM);
  const ArmedFault sync_fault{{.call = Call::kFdatasync, .error = EIO}};
  EXPECT_EQ(::fdatasync(1), -1);
  EXPECT_EQ(errno, EIO);
}

}  // namespace
}  // namespace dampline::fault
