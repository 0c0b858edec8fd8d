// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
