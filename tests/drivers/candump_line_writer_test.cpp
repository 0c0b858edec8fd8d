// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "drivers/candump/line.hpp"
#include "sim_hw/nodes.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::drivers {
namespace {

CanFrame frame_of(std::int64_t time_ns, std::uint32_t id, std::vector<std::uint8_t> data) {
  CanFrame frame;
  frame.time_ns = time_ns;
  frame.id = id;
  frame.length = static_cast<std::uint8_t>(data.size());
  std::ranges::copy(data, frame.data.begin());
  return frame;
}

std::string line_of(const CanFrame& frame, std::string_view interface_name, std::size_t width = 0) {
  fmt::memory_buffer text;
  append_candump(text, frame, interface_name, width);
  return fmt::to_string(text);
}

TEST(CandumpWriter, WritesTheBytesThatCanUtilsWrites) {
  EXPECT_EQ(line_of(frame_of(1'700'000'000'000'200'999, 0x310, {0x0a, 0x1b, 0x2c, 0}), "can0"),
            "(1700000000.000200) can0 310#0A1B2C00\n");
  EXPECT_EQ(line_of(frame_of(1'000'001'999, 0x07, {}), "vcan12"),
            "(0000000001.000001) vcan12 007#\n");
  CanFrame wide = frame_of(1'700'000'000'999'999'999, 0x1abcdef, {1, 2, 3, 4, 5, 6, 7, 255});
  wide.extended = true;
  EXPECT_EQ(line_of(wide, "can1"), "(1700000000.999999) can1 01ABCDEF#01020304050607FF\n");
}

TEST(CandumpWriter, WritesTheOtherKindsOfFrames) {
  CanFrame remote = frame_of(0, 0x123, {});
  remote.remote = true;
  EXPECT_EQ(line_of(remote, "can0"), "(0000000000.000000) can0 123#R\n");
  remote.length = 1;
  EXPECT_EQ(line_of(remote, "can0"), "(0000000000.000000) can0 123#R1\n");
  remote.length = 8;
  EXPECT_EQ(line_of(remote, "can0"), "(0000000000.000000) can0 123#R8\n");
  CanFrame error = frame_of(0, 0x40, {0, 0, 0, 0, 0, 0, 0, 0});  // bus-off
  error.error = true;
  EXPECT_EQ(line_of(error, "can0"), "(0000000000.000000) can0 20000040#0000000000000000\n");
  CanFrame fd = frame_of(0, 0x123, std::vector<std::uint8_t>(12, 0xab));
  fd.fd = true;
  fd.fd_flags = 5;
  EXPECT_EQ(line_of(fd, "can0"), "(0000000000.000000) can0 123##5ABABABABABABABABABABABAB\n");
  fd.length = 0;
  EXPECT_EQ(line_of(fd, "can0"), "(0000000000.000000) can0 123##5\n");
}

TEST(CandumpWriter, WritesNoMoreThanAFrameHolds) {
  CanFrame classic = frame_of(0, 0x123, std::vector<std::uint8_t>(12, 0xab));
  EXPECT_EQ(line_of(classic, "can0"), "(0000000000.000000) can0 123#ABABABABABABABAB\n");
  classic.remote = true;
  EXPECT_EQ(line_of(classic, "can0"), "(0000000000.000000) can0 123#R\n");
  CanFrame fd = frame_of(0, 0x123, std::vector<std::uint8_t>(64, 0xab));
  fd.fd = true;
  fd.length = 65;
  EXPECT_EQ(line_of(fd, "can0").size(),
            std::string{"(0000000000.000000) can0 123##0\n"}.size() + 128);
}

TEST(CandumpWriter, AlignsNamesAsCandumpDoesWithSeveralInterfaces) {
  EXPECT_EQ(line_of(frame_of(0, 1, {}), "can0", 6), "(0000000000.000000)   can0 001#\n");
  EXPECT_EQ(line_of(frame_of(0, 1, {}), "vcan10", 6), "(0000000000.000000) vcan10 001#\n");
}

TEST(CandumpWriter, IsReadBackByTheReader) {
  CanFrame fd = frame_of(1'700'000'000'000'200'000, 0x1fffffff, std::vector<std::uint8_t>(64, 7));
  fd.extended = true;
  fd.fd = true;
  fd.fd_flags = 3;
  const std::string text = line_of(fd, "can0", 6);
  CandumpLine line;
  CanFrame read;
  EXPECT_EQ(line.parse(std::string_view{text}.substr(0, text.size() - 1), read).expected, nullptr);
  EXPECT_EQ(line.interface_name(), "can0");
  EXPECT_EQ(read.fd_flags, 3);
  EXPECT_EQ(line_of(read, "can0", 6), text);
}

TEST(CandumpWriter, WritesLinesOfOneFormOnly) {
  sim::Simulation simulation{sim::reference_run(sim::Load::kLaden, 80.0, 1)};
  sim::SensorNodes nodes{{}, 1};
  for (int i = 0; i < 100; ++i) {
    for (const CanFrame& frame : nodes.pack(simulation.next())) {
      EXPECT_THAT(
          line_of(frame, "can0"),
          ::testing::MatchesRegex("\\([0-9]{10}\\.[0-9]{6}\\) can0 31[012]#[0-9A-F]{6}0[01]\n"));
    }
  }
}

}  // namespace
}  // namespace dampline::drivers
