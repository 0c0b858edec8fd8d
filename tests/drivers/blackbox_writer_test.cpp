// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "drivers/blackbox/writer.hpp"
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

TEST(BlackboxWriter, KeepsFramesAndEventsInTheirOrder) {
  const BoxFolder folder;
  const auto writer = open_box(test::box_config(folder.path()));
  for (std::uint64_t i = 0; i < 10; ++i) {
    writer->write(numbered_frame(i));
    writer->write(hal::Event{numbered_frame(i).time_ns + 1, EventKind::kPulse, 3,
                             static_cast<std::int64_t>(i)});
  }
  writer->close();
  EXPECT_EQ(writer->health().frames, 10U);
  EXPECT_EQ(writer->health().events, 10U);
  EXPECT_EQ(writer->health().lost, 0U);
  EXPECT_EQ(writer->health().files, 1U);
  EXPECT_EQ(writer->health().bytes, std::filesystem::file_size(folder.file(1)));
  auto source = BlackboxSource::open({folder.path(), {}});
  std::vector<CanFrame> frames(100);
  for (std::uint64_t i = 0; i < 10; ++i) {
    ASSERT_EQ(source.value()->read(frames).value(), 1U);
    EXPECT_TRUE(test::same(frames[0], numbered_frame(i)));
    hal::Event event;
    ASSERT_TRUE(source.value()->next_event(event));
    EXPECT_EQ(event.kind, EventKind::kPulse);
    EXPECT_EQ(event.line, 3);
    EXPECT_EQ(event.value, static_cast<std::int64_t>(i));
    EXPECT_FALSE(source.value()->next_event(event));
  }
}

TEST(BlackboxWriter, MakesNoFileBeforeItsFirstRecord) {
  const BoxFolder folder;
  {
    const auto writer = open_box(test::box_config(folder.path()));
    writer->tick(1);
    writer->rotate();
    writer->tick(2 * 3600 * kSecondNs);
    writer->close();
  }
  EXPECT_EQ(folder.files(), 0U);
  EXPECT_TRUE(is_blackbox(folder.path()));
}

TEST(BlackboxWriter, IsOnTheDiskWithinTheSyncInterval) {
  const BoxFolder folder;
  const auto writer = open_box(test::box_config(folder.path()));
  writer->tick(0);
  writer->write(numbered_frame(0));
  const std::uint64_t begun = writer->health().syncs;
  writer->tick(kSecondNs / 10);
  EXPECT_EQ(writer->health().frames, 1U);  // handed to the kernel
  EXPECT_EQ(writer->health().syncs, begun);
  writer->tick(kSecondNs);
  EXPECT_EQ(writer->health().syncs, begun + 1);
  writer->tick(2 * kSecondNs);  // nothing new
  EXPECT_EQ(writer->health().syncs, begun + 1);
  writer->write(numbered_frame(1));
  writer->tick(5 * kSecondNs / 2);
  EXPECT_EQ(writer->health().syncs, begun + 1) << "half a second after the last look";
  writer->tick(3 * kSecondNs);
  EXPECT_EQ(writer->health().syncs, begun + 2);
  EXPECT_EQ(read_box(folder.path()).frames.size(), 2U);
}

// A service may have been started without a standard input.
TEST(BlackboxWriter, WritesWhereItsFileIsDescriptor0) {
  const BoxFolder folder;
  const auto writer = open_box(test::box_config(folder.path()));
  const int input = ::dup(STDIN_FILENO);
  ::close(STDIN_FILENO);
  writer->write(numbered_frame(0));
  writer->tick(0);
  writer->write(numbered_frame(1));
  writer->close();
  if (input >= 0) {
    ::dup2(input, STDIN_FILENO);
    ::close(input);
  }
  EXPECT_EQ(folder.files(), 1U);
  EXPECT_EQ(read_box(folder.path()).numbers(), test::range(0, 2));
}

// The folder goes, and a file stands in its place until it can be made again.
TEST(BlackboxWriter, TriesToGoOnEveryRetryInterval) {
  const BoxFolder folder;
  BlackboxConfig config = test::box_config(folder.path());
  config.retry_ns = 10 * kSecondNs;
  const auto writer = open_box(config);
  const auto records_at = [&](double time_s) {
    writer->tick(static_cast<std::int64_t>(time_s * 1e9));
    return writer->health().recording;
  };
  EXPECT_TRUE(records_at(0.0));
  writer->write(numbered_frame(0));
  EXPECT_TRUE(records_at(1.0));
  std::filesystem::remove_all(folder.path());
  test::write_bytes(folder.path(), "no folder");
  writer->write(numbered_frame(1));
  EXPECT_FALSE(records_at(3.0));
  EXPECT_FALSE(records_at(13.0)) << "tried in vain";
  std::filesystem::remove_all(folder.path());
  EXPECT_FALSE(records_at(22.9)) << "ten seconds after that";
  EXPECT_TRUE(records_at(23.0));
  writer->write(numbered_frame(2));
  writer->close();
  EXPECT_EQ(read_box(folder.path()).frames.size(), 1U);
}

TEST(BlackboxWriter, AFileGoesOnWhereTheLongestRecordJustFits) {
  const BoxFolder measured;
  test::write_box(test::box_config(measured.path()), 0, 99);
  const BoxFolder folder;
  auto config = test::box_config(folder.path());
  config.rotate_bytes = std::filesystem::file_size(measured.file(1)) + kLongestRecord;
  test::write_box(config, 0, 100);
  EXPECT_EQ(folder.files(), 1U);
  --config.rotate_bytes;
  const BoxFolder shorter;
  config.directory = shorter.path();
  test::write_box(config, 0, 100);
  EXPECT_EQ(shorter.files(), 2U);
}

TEST(BlackboxWriter, RotatesBySize) {
  const BoxFolder folder;
  auto config = test::box_config(folder.path());
  config.rotate_bytes = 8192;
  test::write_box(config, 0, 1000);
  EXPECT_GT(folder.files(), 4U);
  for (std::uint32_t i = 1; i <= folder.files(); ++i)
    EXPECT_LE(std::filesystem::file_size(folder.file(i)), 8192U);
  const auto content = read_box(folder.path());
  EXPECT_EQ(content.numbers(), test::range(0, 1000));
  EXPECT_EQ(content.health.dropped, 0U);
  const auto rotated = content.of(EventKind::kFileRotated);
  ASSERT_EQ(rotated.size(), folder.files() - 1);
  auto second = BlackboxSource::open({folder.file(2), {}});  // each can be read alone
  ASSERT_TRUE(second.ok());
  const auto alone = read_box(folder.file(2));
  const auto first = read_box(folder.file(1));
  EXPECT_EQ(alone.numbers().front(), first.numbers().back() + 1);
  EXPECT_EQ(static_cast<std::uint64_t>(rotated[0].value), first.frames.size());
  EXPECT_EQ(alone.health.dropped, 0U);
}

TEST(BlackboxWriter, RotatesAt64MibUnlessToldOtherwise) {
  EXPECT_EQ(BlackboxConfig{}.rotate_bytes, 64U * 1024U * 1024U);
}

TEST(BlackboxWriter, AFilesHourBeginsWithItsFirstRecord) {
  const BoxFolder folder;
  const auto writer = open_box(test::box_config(folder.path()));
  writer->tick(0);
  writer->write(numbered_frame(0));
  writer->tick(1800 * kSecondNs);
  writer->rotate();
  writer->write(numbered_frame(1));
  writer->tick(5399 * kSecondNs);
  writer->write(numbered_frame(2));
  EXPECT_EQ(folder.files(), 2U);
  EXPECT_EQ(writer->health().files, 2U);
  writer->tick(5400 * kSecondNs);
  writer->write(numbered_frame(3));
  EXPECT_EQ(folder.files(), 3U);
  const std::uint64_t syncs = writer->health().syncs;
  writer->rotate();
  writer->write(numbered_frame(4));
  EXPECT_EQ(writer->health().syncs, syncs + 2)
      << "the end of one file and the beginning of the next";
}

// The monotonic clock counts from the start of the computer, and nobody tells it before a tick.
TEST(BlackboxWriter, WhatIsWrittenBeforeTheFirstTickAgesFromThere) {
  const BoxFolder folder;
  const auto writer = open_box(test::box_config(folder.path()));
  writer->write(numbered_frame(0));
  const std::uint64_t begun = writer->health().syncs;
  constexpr std::int64_t kUpNs = 1'000'000 * kSecondNs;
  writer->tick(kUpNs);
  EXPECT_EQ(writer->health().syncs, begun);
  writer->tick(kUpNs + 3599 * kSecondNs);
  writer->write(numbered_frame(1));
  EXPECT_EQ(folder.files(), 1U);
  writer->tick(kUpNs + 3600 * kSecondNs);
  writer->write(numbered_frame(2));
  EXPECT_EQ(folder.files(), 2U);
}

TEST(BlackboxWriter, RotatesByTimeAndWhenAsked) {
  const BoxFolder folder;
  const auto writer = open_box(test::box_config(folder.path()));
  std::int64_t now_ns = 1'000'000 * kSecondNs;
  writer->tick(now_ns);
  writer->write(numbered_frame(0));
  writer->tick(now_ns + 3599 * kSecondNs);
  EXPECT_EQ(folder.files(), 1U);
  writer->tick(now_ns += 3600 * kSecondNs);
  writer->tick(now_ns += 7200 * kSecondNs);  // no record, no file
  EXPECT_EQ(folder.files(), 1U);
  writer->write(numbered_frame(1));
  EXPECT_EQ(folder.files(), 2U);
  writer->rotate();
  writer->rotate();
  writer->write(numbered_frame(2));
  EXPECT_EQ(folder.files(), 3U);
  writer->close();
  const auto content = read_box(folder.path());
  EXPECT_EQ(content.numbers(), test::range(0, 3));
  EXPECT_EQ(content.of(EventKind::kFileRotated).size(), 2U);
}

TEST(BlackboxWriter, RemovesTheOldestFilesAndNothingElse) {
  const BoxFolder folder;
  auto config = test::box_config(folder.path());
  config.rotate_bytes = 8192;
  config.keep_bytes = 40000;
  std::filesystem::create_directories(folder.path());
  for (const char* name : {"blackbox-1.dbb", "notes.txt", "blackbox-000000.dbb.bak"})
    test::write_bytes(folder.path() / name, std::string(100'000, 'x'));
  const auto writer = open_box(config);
  for (std::uint64_t i = 0; i < 5000; ++i) {
    writer->write(numbered_frame(i));
    if (i % 100 == 0) writer->tick(static_cast<std::int64_t>(i) * kSecondNs);
    std::uint64_t bytes = 0;
    std::error_code error;
    for (const auto& file : list_blackbox(folder.path(), error)) bytes += file.bytes;
    ASSERT_LE(bytes, 40000U + 8192U);
  }
  writer->close();
  EXPECT_GT(writer->health().files_removed, 10U);
  const auto content = read_box(folder.path());
  ASSERT_FALSE(content.frames.empty());
  EXPECT_EQ(content.numbers(), test::range(5000 - content.frames.size(), content.frames.size()));
  EXPECT_EQ(content.health.dropped, 0U);  // what was given up on purpose is not lost
  for (const char* name : {"blackbox-1.dbb", "notes.txt", "blackbox-000000.dbb.bak"})
    EXPECT_TRUE(std::filesystem::exists(folder.path() / name)) << name;
}

TEST(BlackboxWriter, NeverRemovesTheCurrentFile) {
  const BoxFolder folder;
  auto config = test::box_config(folder.path());
  config.rotate_bytes = 100'000;
  config.keep_bytes = 1;
  const auto writer = open_box(config);
  for (std::uint64_t i = 0; i < 2000; ++i) {
    writer->write(numbered_frame(i));
    writer->tick(static_cast<std::int64_t>(i) * kSecondNs);
    ASSERT_EQ(folder.files(), 1U);
  }
  EXPECT_EQ(writer->health().lost, 0U);
}

TEST(BlackboxWriter, RemovesFilesByTheirAge) {
  const BoxFolder folder;
  auto config = test::box_config(folder.path());
  config.keep_ns = 3600 * kSecondNs;
  const auto writer = open_box(config);
  for (int hour = 0; hour < 10; ++hour) {
    CanFrame frame = numbered_frame(static_cast<std::uint64_t>(hour));
    frame.time_ns = test::kStartNs + hour * 3600 * kSecondNs;
    writer->write(frame);
    writer->rotate();
  }
  EXPECT_EQ(folder.files(), 3U);  // the newest two hours, and the file that reaches into them
  EXPECT_EQ(read_box(folder.path()).numbers(), test::range(7, 3));
}

// A long file does not keep older ones until its end.
TEST(BlackboxWriter, RemovesOldFilesWhileItWrites) {
  const BoxFolder folder;
  auto config = test::box_config(folder.path());
  config.keep_ns = 600 * kSecondNs;
  const auto writer = open_box(config);
  writer->tick(0);
  const auto write_at = [&](std::int64_t time_s) {
    CanFrame frame = numbered_frame(0);
    frame.time_ns = test::kStartNs + time_s * kSecondNs;
    writer->write(frame);
    writer->tick(time_s * kSecondNs);
    return folder.files();
  };
  EXPECT_EQ(write_at(1), 1U);
  writer->rotate();
  EXPECT_EQ(write_at(2), 2U);
  EXPECT_EQ(write_at(602), 2U) << "just as old as it may be";
  EXPECT_EQ(write_at(604), 1U);
  EXPECT_FALSE(std::filesystem::exists(folder.file(1)));
  EXPECT_EQ(writer->health().files_removed, 1U);
}

TEST(BlackboxWriter, GoesOnInANewFileWithTheNextNumbers) {
  const BoxFolder folder;
  std::uint64_t sequence = 0;
  for (std::uint64_t run = 0; run < 4; ++run) {
    const auto writer = open_box(test::box_config(folder.path()));
    EXPECT_EQ(writer->next_sequence(), sequence);
    for (std::uint64_t i = 0; i < 10; ++i) writer->write(numbered_frame(10 * run + i));
    sequence = writer->next_sequence();
  }
  EXPECT_EQ(folder.files(), 4U);
  const auto content = read_box(folder.path());
  EXPECT_EQ(content.numbers(), test::range(0, 40));
  EXPECT_EQ(content.health.dropped, 0U);
  EXPECT_TRUE(content.of(EventKind::kFileRotated).empty());
}

TEST(BlackboxWriter, FindsTheLastNumberOfALongFileByItsTail) {
  const BoxFolder folder;
  test::write_box(test::box_config(folder.path()), 0, 100'000);
  ASSERT_GT(std::filesystem::file_size(folder.file(1)), 3U << 20U);
  EXPECT_EQ(open_box(test::box_config(folder.path()))->next_sequence(), 100'000U);
}

TEST(BlackboxWriter, GoesOnAfterItsEnd) {
  const BoxFolder folder;
  const auto writer = open_box(test::box_config(folder.path()));
  writer->write(numbered_frame(0));
  writer->close();
  writer->write(numbered_frame(1));
  writer->close();
  EXPECT_EQ(read_box(folder.path()).numbers(), test::range(0, 2));
}

TEST(BlackboxWriter, IsTheOnlyOneInItsDirectory) {
  const BoxFolder folder;
  auto first = open_box(test::box_config(folder.path()));
  const auto second = BlackboxWriter::open(test::box_config(folder.path()));
  ASSERT_FALSE(second.ok());
  EXPECT_THAT(second.error_text(), HasSubstr(folder.path().string()));
  EXPECT_THAT(second.error_text(),
              HasSubstr("is being written to by process " + std::to_string(::getpid())));
  first.reset();
  EXPECT_TRUE(BlackboxWriter::open(test::box_config(folder.path())).ok());
}

TEST(BlackboxWriter, SaysWhatIsWrongWithItsConfiguration) {
  const BoxFolder folder;
  auto config = test::box_config(folder.path());
  config.interfaces.clear();
  EXPECT_THAT(BlackboxWriter::open(config).error_text(), HasSubstr("found 0 interfaces"));
  config.interfaces = {"sixteen_letters_"};
  EXPECT_THAT(BlackboxWriter::open(config).error_text(), HasSubstr("1 to 15 characters"));
  config.interfaces = {"can0"};
  config.rotate_bytes = 100;
  EXPECT_THAT(BlackboxWriter::open(config).error_text(), HasSubstr("4096 bytes at least"));
  const test::BoxFolder file;
  test::write_bytes(file.path(), "x");
  EXPECT_THAT(BlackboxWriter::open(test::box_config(file.path())).error_text(),
              HasSubstr(file.path().string() + ": cannot be made"));
  EXPECT_FALSE(BlackboxWriter::open(test::box_config(file.path() / "inside")).ok());
}

TEST(BlackboxWriter, TakesWhatStandsAtTheEdgesOfItsConfiguration) {
  const auto opens = [](auto change) {
    const BoxFolder folder;
    auto config = test::box_config(folder.path());
    change(config);
    return BlackboxWriter::open(config).ok();
  };
  const auto names = [](std::size_t count, std::size_t length) {
    return [=](BlackboxConfig& c) { c.interfaces.assign(count, std::string(length, 'n')); };
  };
  EXPECT_TRUE(opens(names(1, 1)));
  EXPECT_FALSE(opens(names(1, 0)));
  EXPECT_TRUE(opens(names(27, 15)));
  EXPECT_FALSE(opens(names(28, 15)));
  EXPECT_TRUE(opens([](BlackboxConfig& c) { c.rotate_bytes = 4096; }));
  EXPECT_FALSE(opens([](BlackboxConfig& c) { c.rotate_bytes = 4095; }));
  for (const auto time :
       {&BlackboxConfig::rotate_ns, &BlackboxConfig::sync_interval_ns, &BlackboxConfig::retry_ns}) {
    EXPECT_TRUE(opens([=](BlackboxConfig& c) { c.*time = 1; }));
    EXPECT_FALSE(opens([=](BlackboxConfig& c) { c.*time = 0; }));
  }
  EXPECT_TRUE(opens([](BlackboxConfig& c) { c.keep_ns = 0; }));
  EXPECT_FALSE(opens([](BlackboxConfig& c) { c.keep_ns = -1; }));
}

TEST(BlackboxWriter, LeavesADirectoryOfAnotherVersionAlone) {
  const BoxFolder folder;
  test::write_box(test::box_config(folder.path()), 0, 3);
  BlackboxHeader header;
  header.version = 2;
  std::array<std::uint8_t, kRecordsAt> bytes{};
  encode_header(header, bytes);
  test::write_bytes(folder.file(2), {bytes.begin(), bytes.end()});
  EXPECT_THAT(BlackboxWriter::open(test::box_config(folder.path())).error_text(),
              HasSubstr("is of format version 2, this program writes 1"));
  EXPECT_THAT(read_box(folder.path()).error, HasSubstr("is of format version 2, expected 1"));
}

}  // namespace
}  // namespace dampline::drivers
