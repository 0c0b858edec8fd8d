// SPDX-License-Identifier: MIT
// The black box when its system calls fail, one at a time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <numeric>

#include "tests/blackbox.hpp"
#include "tests/fault/fault_plan.hpp"

namespace dampline::fault {
namespace {

using drivers::BlackboxWriter;
using hal::EventKind;
using test::BoxContent;
using test::BoxFolder;
using test::kSecondNs;
using test::numbered_frame;
using test::read_box;

constexpr std::uint64_t kFrames = 400;

struct Written {
  bool opened{false};
  std::string error;
  hal::RecordHealth health{};
  std::uint64_t sequence{0};
  std::uint64_t safe{0};  ///< frames before the last sync that was known to be good
};

/// A run of 100 s with 4 frames a second, several files, a sync a second.
Written write_run(const BoxFolder& folder, std::uint64_t first = 0) {
  auto config = test::box_config(folder.path());
  config.rotate_bytes = 4096;
  config.keep_bytes = 1U << 20U;
  Written written;
  auto opened = BlackboxWriter::open(config);
  written.opened = opened.ok();
  written.error = opened.error_text();
  if (!opened.ok()) return written;
  BlackboxWriter& writer = *opened.value();
  for (std::uint64_t i = 0; i < kFrames; ++i) {
    writer.write(numbered_frame(first + i));
    if (i % 4 != 3) continue;
    const std::uint64_t lost = writer.health().lost;
    writer.tick(static_cast<std::int64_t>(i / 4) * kSecondNs);
    if (lost == 0 && writer.health().lost == 0) written.safe = i;
  }
  writer.close();
  written.health = writer.health();
  written.sequence = writer.next_sequence();
  return written;
}

std::uint64_t told_lost(const BoxContent& content) {
  std::uint64_t sum = 0;
  for (const hal::Event& event : content.of(EventKind::kRecordingResumed))
    sum += static_cast<std::uint64_t>(event.value);
  return sum;
}

/// What must hold whatever fails: every frame that is read is true and in its order, all that was
/// safe is there, and every other one is accounted for.
void check(const BoxFolder& folder, const Written& written) {
  const BoxContent content = read_box(folder.path());
  if (!content.opened) {  // nothing could ever be written, and the writer says so
    EXPECT_EQ(written.health.frames, 0U);
    EXPECT_GE(written.health.lost, kFrames);
    EXPECT_FALSE(written.health.recording);
    return;
  }
  EXPECT_EQ(content.end, Errc::kEndOfStream);
  EXPECT_TRUE(content.all_true());
  const auto numbers = content.numbers();
  EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end()));
  EXPECT_EQ(content.health.malformed, 0U);
  for (std::uint64_t i = 0; i < written.safe && i < numbers.size(); ++i) ASSERT_EQ(numbers[i], i);
  EXPECT_GE(numbers.size(), written.safe);
  // Every number is a record that is there, one that is known to be missing, or one at the end that
  // the writer knows that it could not write.
  const std::uint64_t there = content.frames.size() + content.events.size();
  const std::uint64_t at_the_end = written.sequence - there - content.findings.missing;
  EXPECT_LE(content.findings.missing + at_the_end, written.health.lost);
  EXPECT_GE(content.frames.size() + written.health.lost, kFrames);
  if (written.health.recording) {
    EXPECT_EQ(at_the_end, 0U);
    EXPECT_EQ(told_lost(content), written.health.lost);
  }
}

class BlackboxCalls : public ::testing::TestWithParam<std::tuple<Call, int, bool>> {};

TEST_P(BlackboxCalls, FailOneAtATimeUntilARunSeesNoFault) {
  const auto [call, error, for_ever] = GetParam();
  bool fired = true;
  for (std::uint64_t nth = 1; fired; ++nth) {
    SCOPED_TRACE("call number " + std::to_string(nth));
    const BoxFolder folder;
    Written written;
    {
      const ArmedFault fault{{call, nth, error, for_ever}};
      written = write_run(folder);
      fired = fault.fired() > 0;
    }
    if (!written.opened) {  // refused, and it says where and why
      ASSERT_THAT(written.error, ::testing::HasSubstr(folder.path().string()));
    } else {
      check(folder, written);
      if (!fired) {
        EXPECT_EQ(written.health.lost, 0U);
      }
    }
    if (::testing::Test::HasFailure()) return;
    // Afterwards all is well again.
    ASSERT_TRUE(write_run(folder, 1000).opened);
    const auto numbers = read_box(folder.path()).numbers();
    ASSERT_GE(numbers.size(), kFrames);
    ASSERT_EQ(numbers.back(), 1000 + kFrames - 1);
    ASSERT_LT(nth, 2000U);
  }
}

INSTANTIATE_TEST_SUITE_P(
    EachKind, BlackboxCalls,
    ::testing::Combine(::testing::Values(Call::kOpen, Call::kWrite, Call::kFdatasync, Call::kFsync,
                                         Call::kFtruncate, Call::kUnlink, Call::kFlock,
                                         Call::kClose, Call::kRead),
                       ::testing::Values(EIO, ENOSPC), ::testing::Bool()));

INSTANTIATE_TEST_SUITE_P(ShortWritesAndReads, BlackboxCalls,
                         ::testing::Combine(::testing::Values(Call::kWrite, Call::kRead),
                                            ::testing::Values(kShort, EINTR),
                                            ::testing::Values(false)));

TEST(BlackboxFault, ShortWritesAreFinished) {
  const BoxFolder folder;
  const ArmedFault fault{{Call::kWrite, 1, kShort, true}};
  const Written written = write_run(folder);
  EXPECT_EQ(written.health.lost, 0U);
  EXPECT_GT(fault.fired(), 1000U);
  EXPECT_EQ(read_box(folder.path()).numbers(), test::range(0, kFrames));
}

TEST(BlackboxFault, AFailedSyncIsTheEndOfItsFileAndIsTold) {
  const BoxFolder folder;
  const auto writer = test::open_box(test::box_config(folder.path()));
  writer->tick(0);
  for (std::uint64_t i = 0; i < 5; ++i) writer->write(numbered_frame(i));
  writer->tick(kSecondNs);
  for (std::uint64_t i = 5; i < 8; ++i) writer->write(numbered_frame(i));
  {
    const ArmedFault fault{{Call::kFdatasync, 1, EIO, false}};
    writer->tick(2 * kSecondNs);
    EXPECT_EQ(fault.fired(), 1U);
    EXPECT_EQ(fault.calls(), 2U);  // not again for that file; the second is the new one's
  }
  const std::string old_file = test::bytes_of(folder.file(1));
  EXPECT_TRUE(writer->health().recording);
  EXPECT_EQ(writer->health().failed_syncs, 1U);
  EXPECT_EQ(writer->health().last_errno, EIO);
  EXPECT_EQ(writer->health().lost, 3U);
  writer->write(numbered_frame(8));
  writer->close();
  EXPECT_EQ(test::bytes_of(folder.file(1)), old_file);
  EXPECT_EQ(folder.files(), 2U);
  const BoxContent content = read_box(folder.path());
  ASSERT_EQ(content.of(EventKind::kRecordingStopped).size(), 1U);
  EXPECT_EQ(content.of(EventKind::kRecordingStopped)[0].value, EIO);
  EXPECT_EQ(told_lost(content), 3U);
  // Here the disk has them all the same.
  EXPECT_EQ(content.numbers(), test::range(0, 9));
}

TEST(BlackboxFault, AFullDiskStopsRecordingWhichGoesOnByItself) {
  const BoxFolder folder;
  const auto writer = test::open_box(test::box_config(folder.path()));
  writer->tick(0);
  std::uint64_t next = 0;
  for (; next < 10; ++next) writer->write(numbered_frame(next));
  writer->tick(kSecondNs);
  {
    const ArmedFault fault{{Call::kWrite, 1, ENOSPC, true}};
    for (; next < 20; ++next) writer->write(numbered_frame(next));
    writer->tick(2 * kSecondNs);
    EXPECT_FALSE(writer->health().recording);
    EXPECT_EQ(writer->health().last_errno, ENOSPC);
    for (; next < 30; ++next) writer->write(numbered_frame(next));
    const std::uint64_t calls = fault.calls();
    writer->tick(6 * kSecondNs);
    EXPECT_EQ(fault.calls(), calls);  // not at every tick
    writer->tick(7 * kSecondNs);
    EXPECT_GT(fault.calls(), calls);
    EXPECT_FALSE(writer->health().recording);
    EXPECT_EQ(folder.files(), 1U);  // attempts leave nothing behind
  }
  writer->tick(11 * kSecondNs);
  EXPECT_FALSE(writer->health().recording);
  writer->tick(12 * kSecondNs);
  EXPECT_TRUE(writer->health().recording);
  for (; next < 40; ++next) writer->write(numbered_frame(next));
  writer->close();
  EXPECT_EQ(writer->health().lost, 20U);
  const BoxContent content = read_box(folder.path());
  auto expected = test::range(0, 10);
  for (const std::uint64_t number : test::range(30, 10)) expected.push_back(number);
  EXPECT_EQ(content.numbers(), expected);
  EXPECT_EQ(content.health.dropped, 20U);
  EXPECT_EQ(content.health.malformed, 0U);  // cut back to whole records
  EXPECT_EQ(told_lost(content), 20U);
  ASSERT_EQ(content.of(EventKind::kRecordingStopped).size(), 1U);
  EXPECT_EQ(content.of(EventKind::kRecordingStopped)[0].time_ns, numbered_frame(19).time_ns);
  EXPECT_EQ(content.of(EventKind::kRecordingStopped)[0].value, ENOSPC);
}

TEST(BlackboxFault, AFileThatTookNoRecordIsRemoved) {
  const BoxFolder folder;
  const auto writer = test::open_box(test::box_config(folder.path()));
  writer->tick(0);
  writer->write(numbered_frame(0));
  writer->write(numbered_frame(1));
  ASSERT_EQ(folder.files(), 1U);
  const ArmedFault fault{{Call::kWrite, 1, ENOSPC, true}};
  writer->tick(kSecondNs);
  EXPECT_FALSE(writer->health().recording);
  EXPECT_EQ(writer->health().lost, 2U);
  EXPECT_EQ(folder.files(), 0U);
}

TEST(BlackboxFault, WhatFailedBeforeTheFirstTickIsTriedAgainAtIt) {
  const BoxFolder folder;
  const auto writer = test::open_box(test::box_config(folder.path()));
  {
    const ArmedFault fault{{Call::kOpen, 1, ENOSPC, true}};
    writer->write(numbered_frame(0));
    EXPECT_FALSE(writer->health().recording);
  }
  writer->tick(1);
  EXPECT_TRUE(writer->health().recording);
}

TEST(BlackboxFault, AReadThatFailsIsSaidAndNotTakenForTheEnd) {
  const BoxFolder folder;
  test::write_box(test::box_config(folder.path()), 0, 20000);
  bool fired = true;
  for (std::uint64_t nth = 1; fired; ++nth) {
    const ArmedFault fault{{Call::kRead, nth, EIO, false}};
    const BoxContent content = read_box(folder.path());
    fired = fault.fired() > 0;
    if (!fired) {
      EXPECT_EQ(content.frames.size(), 20000U);
      EXPECT_EQ(content.end, Errc::kEndOfStream);
      break;
    }
    EXPECT_NE(content.end, Errc::kEndOfStream) << nth;
    EXPECT_THAT(content.error, ::testing::HasSubstr("blackbox-000001.dbb: cannot be read")) << nth;
    EXPECT_TRUE(content.all_true());
  }
}

}  // namespace
}  // namespace dampline::fault
