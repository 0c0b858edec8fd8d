// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "drivers/blackbox/source.hpp"
#include "tests/blackbox.hpp"

namespace dampline::drivers {
namespace {

using hal::EventKind;
using test::BoxFolder;
using test::kSecondNs;
using test::numbered_frame;
using test::open_box;
using test::read_box;
using ::testing::HasSubstr;

TEST(BlackboxSource, SaysWhatItFoundInsteadOfABlackBox) {
  const BoxFolder folder;
  EXPECT_THAT(read_box(folder.path()).error, HasSubstr("no such file or directory"));
  std::filesystem::create_directories(folder.path());
  EXPECT_FALSE(is_blackbox(folder.path()));
  EXPECT_THAT(read_box(folder.path()).error,
              HasSubstr("holds no black box file, expected names such as blackbox-000001.dbb"));
  EXPECT_THAT(read_box("/dev/null").error, HasSubstr("neither a directory nor a file"));
  const auto text = folder.path() / "text.log";
  test::write_bytes(text, std::string(2000, 'x'));
  EXPECT_FALSE(is_blackbox(text));
  EXPECT_THAT(read_box(text).error, HasSubstr("text.log: has no header of a black box file"));
  test::write_bytes(folder.file(1), "");
  EXPECT_TRUE(is_blackbox(folder.path()));
  EXPECT_THAT(read_box(folder.path()).error, HasSubstr("is cut off in its header"));
}

TEST(BlackboxSource, KnowsABlackBoxByItsContent) {
  const BoxFolder folder;
  test::write_box(test::box_config(folder.path()), 0, 3);
  EXPECT_TRUE(is_blackbox(folder.path()));
  EXPECT_TRUE(is_blackbox(folder.file(1)));
  const auto renamed = folder.path() / "yesterday";
  std::filesystem::rename(folder.file(1), renamed);
  EXPECT_TRUE(is_blackbox(renamed));
  EXPECT_EQ(read_box(renamed).numbers(), test::range(0, 3));
}

TEST(BlackboxSource, NamesTheInterfacesOfEveryFileByTheirNames) {
  const BoxFolder folder;
  auto config = test::box_config(folder.path());
  test::write_box(config, 0, 10);
  config.interfaces = {"vcan10", "can0"};  // the other way round
  test::write_box(config, 10, 10);
  auto source = BlackboxSource::open({folder.path(), {}});
  ASSERT_EQ(source.value()->interfaces().size(), 2U);
  std::vector<CanFrame> frames(100);
  std::uint64_t number = 0;
  for (auto count = source.value()->read(frames); count.ok();
       count = source.value()->read(frames)) {
    for (std::size_t i = 0; i < count.value(); ++i, ++number) {
      const bool second = numbered_frame(number).interface_index == 1;
      EXPECT_EQ(source.value()->interfaces().name(frames[i].interface_index),
                second == (number < 10) ? "vcan10" : "can0")
          << number;
    }
  }
  EXPECT_EQ(number, 20U);
}

TEST(BlackboxSource, GivesOnlyTheInterfacesThatWereAskedFor) {
  const BoxFolder folder;
  test::write_box(test::box_config(folder.path()), 0, 70);
  auto source = BlackboxSource::open({folder.path(), {"vcan10"}});
  std::vector<CanFrame> frames(100);
  EXPECT_EQ(source.value()->read(frames).value(), 10U);
  EXPECT_EQ(source.value()->health().ignored, 60U);
}

TEST(BlackboxSource, RestoresWhatTheLiveRunCounted) {
  const BoxFolder folder;
  const auto writer = open_box(test::box_config(folder.path()));
  const auto tell = [&](EventKind kind, std::int64_t value) {
    writer->write(hal::Event{test::kStartNs, kind, 0, value});
  };
  tell(EventKind::kRunStart, 0);
  tell(EventKind::kLinkDown, 0);
  tell(EventKind::kLinkUp, 0);
  tell(EventKind::kLinkDown, 0);
  tell(EventKind::kInterfaceRemoved, 0);
  tell(EventKind::kInterfaceBack, 0);
  tell(EventKind::kBusOff, 0);
  tell(EventKind::kBusRestarted, 0);
  tell(EventKind::kClockStep, -7);
  tell(EventKind::kFramesDropped, 40);
  tell(EventKind::kRecordsLost, 2);
  CanFrame error = numbered_frame(0);
  error.error = true;
  error.time_source = TimeSource::kHardware;
  writer->write(error);
  writer->close();
  const hal::SourceHealth health = read_box(folder.path()).health;
  EXPECT_EQ(health.link_downs, 2U);
  EXPECT_EQ(health.reopened, 1U);
  EXPECT_EQ(health.bus_offs, 1U);
  EXPECT_EQ(health.restarts, 1U);
  EXPECT_EQ(health.clock_steps, 1U);
  EXPECT_EQ(health.dropped, 42U);
  EXPECT_EQ(health.frames, 1U);
  EXPECT_EQ(health.error_frames, 1U);
  EXPECT_EQ(health.hardware_times, 1U);
  EXPECT_FALSE(health.link_up);
}

TEST(BlackboxSource, MovesARunThatBeganBeforeTheOneBeforeHadEnded) {
  const BoxFolder folder;
  const auto config = test::box_config(folder.path());
  test::write_box(config, 100, 50);
  test::write_box(config, 0, 50);
  const auto content = read_box(folder.path());
  ASSERT_EQ(content.frames.size(), 100U);
  EXPECT_EQ(content.findings.runs_moved, 1U);
  EXPECT_EQ(content.health.reordered, 0U);
  EXPECT_EQ(content.frames[50].time_ns, content.frames[49].time_ns);
  for (std::size_t i = 51; i < 100; ++i)
    EXPECT_EQ(content.frames[i].time_ns - content.frames[50].time_ns,
              static_cast<std::int64_t>(i - 50) * 1'111'000);
}

// Its files are of one run, and stay as far apart as they were.
TEST(BlackboxSource, MovesAllFilesOfARun) {
  const BoxFolder folder;
  auto config = test::box_config(folder.path());
  test::write_box(config, 1000, 50);
  config.rotate_bytes = 4096;
  test::write_box(config, 0, 500);
  ASSERT_GT(folder.files(), 4U);
  const auto content = read_box(folder.path());
  ASSERT_EQ(content.frames.size(), 550U);
  EXPECT_EQ(content.findings.runs_moved, 1U);
  EXPECT_EQ(content.health.reordered, 0U);
  for (std::size_t i = 50; i < 550; ++i)
    ASSERT_EQ(content.frames[i].time_ns - content.frames[49].time_ns,
              static_cast<std::int64_t>(i - 50) * 1'111'000);
  EXPECT_EQ(content.findings.first_ns, content.frames[0].time_ns);
  EXPECT_EQ(content.findings.newest_ns, content.frames.back().time_ns);
}

// A clock that stands at the ends of what it can hold, as in a file that was made to do harm.
TEST(BlackboxSource, ATimeThatIsMovedStopsAtTheEndOfTheClock) {
  constexpr std::int64_t kEarliest = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kLatest = std::numeric_limits<std::int64_t>::max();
  const BoxFolder folder;
  const auto write = [&](std::vector<std::int64_t> times_ns) {
    const auto writer = open_box(test::box_config(folder.path()));
    CanFrame frame = numbered_frame(0);
    for (const std::int64_t time_ns : times_ns) {
      frame.time_ns = time_ns;
      writer->write(frame);
    }
  };
  write({kLatest - 10});
  write({0, 9, 10, 11, kLatest});
  auto content = read_box(folder.path());
  ASSERT_EQ(content.frames.size(), 6U);
  EXPECT_EQ(content.frames[1].time_ns, kLatest - 10);
  EXPECT_EQ(content.frames[2].time_ns, kLatest - 1);
  for (const std::size_t i : {3U, 4U, 5U}) EXPECT_EQ(content.frames[i].time_ns, kLatest) << i;
  EXPECT_EQ(content.findings.runs_moved, 1U);
  write({kEarliest});
  content = read_box(folder.path());
  EXPECT_EQ(content.findings.runs_moved, 2U);
  EXPECT_EQ(content.frames.back().time_ns, kLatest) << "held, as no clock reaches so far";
  EXPECT_EQ(content.health.reordered, 1U);
}

TEST(BlackboxSource, SaysWhereTheLastFileEnds) {
  const BoxFolder folder;
  test::write_box(test::box_config(folder.path()), 0, 10);
  test::write_box(test::box_config(folder.path()), 10, 10);
  const auto cut = [&](std::uint32_t number, std::uintmax_t bytes) {
    const auto size = std::filesystem::file_size(folder.file(number));
    std::filesystem::resize_file(folder.file(number), size - std::min(bytes, size));
  };
  cut(1, 3);
  auto content = read_box(folder.path());
  EXPECT_EQ(content.findings.torn_ends, 1U);
  EXPECT_EQ(content.findings.files, 2U);
  EXPECT_FALSE(content.health.truncated) << "a run came after it";
  EXPECT_EQ(content.health.dropped, 1U) << "the run behind it knows how many there were";
  cut(2, 3);
  content = read_box(folder.path());
  EXPECT_EQ(content.findings.torn_ends, 2U);
  EXPECT_TRUE(content.health.truncated);
  cut(2, 1U << 20U);
  content = read_box(folder.path());
  EXPECT_EQ(content.findings.torn_ends, 2U);
  EXPECT_EQ(content.findings.files, 1U);
  EXPECT_TRUE(content.health.truncated);
  EXPECT_EQ(content.numbers(), test::range(0, 9));
}

TEST(BlackboxSource, HoldsATimeThatGoesBackWithinARun) {
  const BoxFolder folder;
  {
    const auto writer = open_box(test::box_config(folder.path()));
    for (const std::uint64_t number : {5U, 4U, 6U}) writer->write(numbered_frame(number));
  }
  const auto content = read_box(folder.path());
  EXPECT_EQ(content.health.reordered, 1U);
  EXPECT_EQ(content.frames[1].time_ns, content.frames[0].time_ns);
  EXPECT_EQ(content.findings.runs_moved, 0U);
}

TEST(BlackboxSource, ReadsTheSameInBatchesOfAnySize) {
  const BoxFolder folder;
  {
    const auto writer = open_box(test::box_config(folder.path()));
    for (std::uint64_t i = 0; i < 20000; ++i) {
      writer->write(numbered_frame(i));
      if (i % 97 < 2) writer->write(hal::Event{test::kStartNs, EventKind::kPulse, 0, 1});
    }
  }
  for (const std::size_t some : {1U, 7U, 64U, 30000U}) {
    const auto content = read_box(folder.path(), some);
    EXPECT_EQ(content.numbers(), test::range(0, 20000)) << some;
    EXPECT_TRUE(content.all_true());
    EXPECT_EQ(content.events.size(), 414U);
  }
}

TEST(BlackboxSource, GoesOnWhereAFileIsGoneAndCountsWhatWasInIt) {
  const BoxFolder folder;
  auto config = test::box_config(folder.path());
  config.rotate_bytes = 8192;
  test::write_box(config, 0, 500);
  const auto second = read_box(folder.file(2));
  auto source = BlackboxSource::open({folder.path(), {}});
  std::filesystem::remove(folder.file(2));
  std::vector<CanFrame> frames(100);
  std::size_t count = 0;
  for (auto read = source.value()->read(frames); read.ok(); read = source.value()->read(frames))
    count += read.value();
  EXPECT_EQ(count, 500 - second.frames.size());
  EXPECT_EQ(source.value()->health().dropped, second.frames.size() + second.events.size());
  EXPECT_EQ(source.value()->findings().unreadable_files, 1U);
}

}  // namespace
}  // namespace dampline::drivers
