// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/candump/line.hpp"
#include "program.hpp"
#include "tests/blackbox.hpp"

namespace dampline::app {
namespace {

using test::numbered_frame;
using ::testing::HasSubstr;

/// A black box "box" of 50 frames, and an event after the 20th.
void record(const Program& program) {
  const auto writer = test::open_box(test::box_config(program.path("box")));
  for (std::uint64_t i = 0; i < 50; ++i) {
    writer->write(numbered_frame(i));
    if (i == 19)
      writer->write(hal::Event{1'700'000'000'000'000'007, hal::EventKind::kClockStep, 2, -5});
  }
}

std::string expected_log() {
  fmt::memory_buffer text;
  for (std::uint64_t i = 0; i < 50; ++i) {
    const CanFrame frame = numbered_frame(i);
    drivers::append_candump(text, frame, frame.interface_index == 0 ? "can0" : "vcan10", 6);
  }
  return fmt::to_string(text);
}

TEST(Export, WritesCandumpTextAndTheEvents) {
  const Program program;
  record(program);
  const auto outcome = program.run("export box --out run.log --events events.csv");
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_EQ(outcome.output, "");
  EXPECT_EQ(program.read("run.log"), expected_log());
  EXPECT_EQ(program.read("events.csv"),
            "time_s,event,line,value\n1700000000.000000007,clock_step,2,-5\n");
  EXPECT_THAT(outcome.error, HasSubstr("50 frames and 1 events of 1 files -> run.log"));
  EXPECT_THAT(outcome.error, HasSubstr("from 1700000000.000000000 to 1700000000.054439000 s"));
  EXPECT_THAT(outcome.error, HasSubstr("0 damaged stretches, 0 records missing, 0 files torn"));
}

TEST(Export, WritesToStandardOutput) {
  const Program program;
  record(program);
  const auto outcome = program.run("export box/blackbox-000001.dbb --quiet");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.output, expected_log());
  EXPECT_EQ(outcome.error, "");
}

TEST(Export, SaysWhatIsMissing) {
  const Program program;
  record(program);
  std::string bytes = program.read("box/blackbox-000001.dbb");
  bytes[2000] = static_cast<char>(~bytes[2000]);
  program.write("box/blackbox-000001.dbb", bytes.substr(0, bytes.size() - 3));
  const auto outcome = program.run("export box --out run.log");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.error, HasSubstr("48 frames"));
  EXPECT_THAT(outcome.error, HasSubstr("1 damaged stretches, 1 records missing, 1 files torn"));
}

TEST(Export, SaysWhatItFoundInstead) {
  const Program program;
  program.write("frames.log", std::string(2000, '('));
  auto outcome = program.run("export frames.log --out x.log");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.error, HasSubstr("frames.log: has no header of a black box file"));
  EXPECT_FALSE(program.exists("x.log"));
  outcome = program.run("export nowhere");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.error, HasSubstr("nowhere: no such file or directory"));
  record(program);
  EXPECT_EQ(program.run("export box --out x --events x").code, 2);
  EXPECT_EQ(program.run("export box --events -").code, 2);
  EXPECT_EQ(program.run("export box --out /dev/full").code, 1);
}

}  // namespace
}  // namespace dampline::app
