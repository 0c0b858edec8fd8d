// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "drivers/candump/source.hpp"
#include "temporary_file.hpp"
#include "tests/shared_data.hpp"

namespace dampline::drivers {
namespace {
using test::TemporaryFile;
using ::testing::HasSubstr;

struct Outcomes {
  std::vector<CanFrame> frames;
  hal::SourceHealth health;
  Errc end{};
  std::string error;
};

Outcomes read_all(FrameFileConfig config, std::string_view text) {
  const TemporaryFile file{text, ".log"};
  config.path = file.path();
  auto source = CandumpSource::open(config);
  EXPECT_TRUE(source.ok()) << source.error_text();
  Outcomes all;
  std::array<CanFrame, 7> some;  // an odd number, so that ends of reads fall everywhere
  for (;;) {
    const auto count = source.value()->read(some);
    if (!count.ok()) {
      all.end = count.error();
      break;
    }
    all.frames.insert(all.frames.end(), some.begin(),
                      some.begin() + static_cast<std::ptrdiff_t>(count.value()));
  }
  all.health = source.value()->health();
  all.error = source.value()->error_text();
  const std::size_t at = all.error.find(file.path());
  if (at != std::string::npos) all.error.replace(at, file.path().size(), "FILE");
  return all;
}

std::string line(double time_s, const char* rest = "can0 123#11223344") {
  return fmt::format("({:.6f}) {}\n", time_s, rest);
}

TEST(CandumpSource, ReadsFramesInOrder) {
  std::string text;
  for (int i = 0; i < 100; ++i) text += line(1000.0 + 0.01 * i);
  const Outcomes all = read_all({}, text);
  EXPECT_EQ(all.frames.size(), 100U);
  EXPECT_EQ(all.end, Errc::kEndOfStream);
  EXPECT_EQ(all.error, "");
  EXPECT_EQ(all.health.frames, 100U);
  EXPECT_FALSE(all.health.truncated);
  EXPECT_EQ(all.frames[42].time_ns, 1000'420'000'000);
}

TEST(CandumpSource, FramesOfOneTimeAreInOrder) {
  const Outcomes all = read_all({}, line(1.0) + line(1.0) + line(2.0) + line(1.5));
  EXPECT_EQ(all.frames.size(), 4U);
  EXPECT_EQ(all.health.reordered, 1U);
}

TEST(CandumpSource, IgnoresAndCountsLinesThatAreNoFrames) {
  const Outcomes all =
      read_all({}, "# comment\n\n" + line(1.0) + "  (2.000000) can0 123#\n" + line(2.0));
  EXPECT_EQ(all.frames.size(), 2U);
  EXPECT_EQ(all.health.ignored, 3U);
}

TEST(CandumpSource, ReportsFileLineAndColumnOfAMalformedLine) {
  const Outcomes all = read_all({}, line(1.0) + line(2.0) + "(3.000000) can0 123#1\n" + line(4.0));
  EXPECT_EQ(all.frames.size(), 2U);
  EXPECT_EQ(all.end, Errc::kMalformed);
  EXPECT_EQ(all.error, "FILE:3:21: found \"1\", expected two hexadecimal digits a byte");
  EXPECT_EQ(all.health.malformed, 1U);
}

TEST(CandumpSource, CountsMalformedLinesWhenAskedTo) {
  const Outcomes all =
      read_all({.skip_bad_lines = true}, line(1.0) + "(3.000000) can0 123#1\n(\n" + line(4.0));
  EXPECT_EQ(all.frames.size(), 2U);
  EXPECT_EQ(all.end, Errc::kEndOfStream);
  EXPECT_EQ(all.health.malformed, 2U);
}

TEST(CandumpSource, HoldsATimeThatGoesBackALittle) {
  const Outcomes all = read_all({}, line(10.0) + line(9.5) + line(10.2));
  ASSERT_EQ(all.frames.size(), 3U);
  EXPECT_EQ(all.frames[1].time_ns, 10'000'000'000);
  EXPECT_EQ(all.frames[2].time_ns, 10'200'000'000);
  EXPECT_EQ(all.health.reordered, 1U);
}

TEST(CandumpSource, RefusesATimeThatGoesBackASecond) {
  const Outcomes all = read_all({}, line(10.0) + line(10.1) + line(9.1));
  EXPECT_EQ(all.frames.size(), 2U);
  EXPECT_EQ(all.end, Errc::kMalformed);
  EXPECT_THAT(all.error,
              HasSubstr("FILE:3:1: found \"(9.100000) can0 123#11223344\", expected a time that"));
}

TEST(CandumpSource, SkipsOneLineWhoseTimeLeapsAhead) {
  const std::string text =
      line(8000.0) + line(10.0) + line(11.0) + line(9011.0) + line(11.5) + line(12.0);
  const Outcomes all = read_all({.skip_bad_lines = true}, text);
  ASSERT_EQ(all.frames.size(), 4U);
  EXPECT_EQ(all.frames.front().time_ns, 10'000'000'000);
  EXPECT_EQ(all.health.malformed, 2U);
  EXPECT_THAT(read_all({}, text).error, HasSubstr("FILE:1: expected a time that is not"));
}

// It is wrong where more than half of what follows is a second or more before it.
TEST(CandumpSource, MostOfTheNextLinesTellWhetherALineLeapsAhead) {
  const auto first_ns = [](const std::string& text) {
    return read_all({.skip_bad_lines = true}, text).frames.front().time_ns;
  };
  EXPECT_EQ(first_ns(line(8000.0) + line(10.0)), 10'000'000'000) << "one of one";
  EXPECT_EQ(first_ns(line(8000.0) + line(10.0) + line(8000.5)), 8000'000'000'000) << "half";
  EXPECT_EQ(first_ns(line(8000.0) + line(7999.0)), 7999'000'000'000) << "a second";
  EXPECT_EQ(first_ns(line(8000.0) + line(7999.001)), 8000'000'000'000) << "less";
  EXPECT_EQ(first_ns(line(8000.0) + "# 1\n# 2\n" + line(10.0)), 10'000'000'000);
  EXPECT_EQ(read_all({.skip_bad_lines = true}, line(8000.0)).frames.size(), 1U) << "none follows";
}

TEST(CandumpSource, BearsAPause) {
  EXPECT_EQ(read_all({}, line(10.0) + line(5000.0) + line(5000.1)).frames.size(), 3U);
}

TEST(CandumpSource, NumbersInterfacesAsTheyAppear) {
  const TemporaryFile file{line(1.0, "can1 001#") + line(2.0, "can0 001#") +
                           line(3.0, "can1 001#")};
  auto source = CandumpSource::open({.path = file.path()});
  std::array<CanFrame, 10> frames;
  ASSERT_EQ(source.value()->read(frames).value(), 3U);
  EXPECT_EQ(frames[0].interface_index, 0);
  EXPECT_EQ(frames[1].interface_index, 1);
  EXPECT_EQ(frames[2].interface_index, 0);
  ASSERT_EQ(source.value()->interfaces().size(), 2U);
  EXPECT_EQ(source.value()->interfaces().name(0), "can1");
  EXPECT_EQ(source.value()->interfaces().name(1), "can0");
}

TEST(CandumpSource, DeliversTheInterfacesThatWereAskedFor) {
  FrameFileConfig config;
  config.interfaces = {"can0", "vcan3"};
  const Outcomes all =
      read_all(config, line(1.0, "can1 001#") + line(2.0, "can0 002#") + line(3.0, "vcan3 003#"));
  ASSERT_EQ(all.frames.size(), 2U);
  EXPECT_EQ(all.frames[0].id, 2U);
  EXPECT_EQ(all.health.ignored, 1U);
  EXPECT_EQ(read_all(config, line(1.0, "can1 001#")).end, Errc::kEndOfStream);
}

TEST(CandumpSource, BearsDosLineEndsAndDirections) {
  const Outcomes all = read_all(
      {}, "(1.000000) can0 123#11\r\n(2.000000001) can0 123#11 R\r\n(3.000000) can0 123#11 T\n");
  EXPECT_EQ(all.frames.size(), 3U);
}

TEST(CandumpSource, SaysThatAFileIsEmpty) {
  const Outcomes all = read_all({}, "");
  EXPECT_EQ(all.end, Errc::kMalformed);
  EXPECT_THAT(all.error, HasSubstr("FILE: is empty, expected lines such as"));
}

TEST(CandumpSource, SaysWhatAFileOfAnotherKindHolds) {
  EXPECT_THAT(read_all({}, "time_s,force_n\n0,1\n").error,
              HasSubstr("looks like a table (CSV) beginning \"time_s,force_n\""));
  std::string binary;
  std::mt19937 random{1};
  for (int i = 0; i < 500'000; ++i) binary += static_cast<char>(random());
  binary[3] = '\0';
  for (const bool skip : {false, true}) {
    const Outcomes all = read_all({.skip_bad_lines = skip}, binary);
    EXPECT_EQ(all.end, Errc::kMalformed);
    EXPECT_NE(all.error, "");
  }
  EXPECT_THAT(read_all({}, std::string(5'000'000, '\0')).error, HasSubstr("binary data beginning"));
  EXPECT_THAT(read_all({}, "no newline").error,
              HasSubstr("found no frame beginning \"no newline\""));
}

TEST(CandumpSource, SaysThatAFileCannotBeOpened) {
  EXPECT_THAT(CandumpSource::open({.path = "/nonexistent.log"}).error_text(),
              HasSubstr("/nonexistent.log: cannot be opened: No such file"));
  EXPECT_THAT(CandumpSource::open({.path = "/"}).error_text(), HasSubstr("directory"));
}

TEST(CandumpSource, ReadsALogThatWasCutAnywhereUpToThere) {
  std::string text;
  std::vector<std::size_t> ends{0};
  for (int i = 0; i < 12; ++i) {
    text += line(1.0 + i, i % 3 == 0 ? "can0 18FF0001#1122334455667788" : "can1 123#11 R");
    ends.push_back(text.size());
  }
  for (std::size_t length = 0; length <= text.size(); ++length) {
    const Outcomes all = read_all({}, std::string_view{text}.substr(0, length));
    const auto whole = std::upper_bound(ends.begin(), ends.end(), length) - ends.begin() - 1;
    EXPECT_EQ(static_cast<std::ptrdiff_t>(all.frames.size()), whole) << length;
    EXPECT_EQ(all.health.truncated, std::find(ends.begin(), ends.end(), length) == ends.end())
        << length;
    EXPECT_EQ(all.end, whole > 0 ? Errc::kEndOfStream : Errc::kMalformed) << length;
  }
}

class CorruptedLog : public ::testing::TestWithParam<int> {};

/// Every line is a frame, or counted; nothing is lost silently and time never goes back.
TEST_P(CorruptedLog, LeavesEveryLineAccountedFor) {
  std::string text;
  for (int i = 0; i < 4000; ++i) {
    text += line(1600000000.0 + i / 300.0, i % 7 == 0 ? "can0 18FF0001#1122" : "can0 123#11223344");
  }
  std::mt19937 random{static_cast<unsigned>(GetParam())};
  const double share = GetParam() % 2 == 0 ? 0.1 : 0.005;
  std::bernoulli_distribution corrupt{share};
  for (char& c : text) {
    if (corrupt(random)) c = static_cast<char>(random());
  }
  const Outcomes all = read_all({.skip_bad_lines = true}, text);
  const auto lines = static_cast<std::uint64_t>(std::count(text.begin(), text.end(), '\n'));
  EXPECT_EQ(all.health.frames, all.frames.size());
  if (all.end == Errc::kEndOfStream) {
    EXPECT_EQ(all.health.frames + all.health.malformed + all.health.ignored, lines);
  }
  EXPECT_EQ(all.health.truncated, text.back() != '\n');
  for (std::size_t i = 1; i < all.frames.size(); ++i) {
    EXPECT_GE(all.frames[i].time_ns, all.frames[i - 1].time_ns);
  }
  if (share < 0.01) {  // most lines are whole, and none blocks the rest
    EXPECT_GT(all.frames.size(), 3000U);
  }
  const Outcomes strict = read_all({}, text);
  EXPECT_EQ(strict.end, Errc::kMalformed);
  EXPECT_THAT(strict.error, HasSubstr("expected"));
}

INSTANTIATE_TEST_SUITE_P(Seeds, CorruptedLog, ::testing::Range(0, 20));

TEST(CandumpSource, DecodesTheMeasuredLogAsItsNotesSay) {
  const auto path = test::shared_data() / "can_log" / "can_sample.log";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "measured data not found: " << path;
  auto source = CandumpSource::open({.path = path.string()});
  ASSERT_TRUE(source.ok()) << source.error_text();
  std::vector<CanFrame> frames(100'000);
  ASSERT_EQ(source.value()->read(frames).value(), 82558U);
  EXPECT_EQ(source.value()->read(frames).error(), Errc::kEndOfStream);
  EXPECT_EQ(source.value()->interfaces().size(), 1U);
  EXPECT_NEAR(static_cast<double>(frames[82557].time_ns - frames[0].time_ns) * 1e-9, 90.282082,
              1e-9);
}

}  // namespace
}  // namespace dampline::drivers
