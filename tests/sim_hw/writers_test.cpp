// SPDX-License-Identifier: MIT
#include "sim_hw/writers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "sim_hw/faults.hpp"
#include "sim_hw/nodes.hpp"
#include "sim_hw/presets.hpp"

namespace dampline::sim {
namespace {

CanFrame frame_of(std::int64_t time_ns, std::uint32_t id, std::vector<std::uint8_t> data) {
  CanFrame frame;
  frame.time_ns = time_ns;
  frame.id = id;
  frame.length = static_cast<std::uint8_t>(data.size());
  std::ranges::copy(data, frame.data.begin());
  return frame;
}

std::string line_of(const CanFrame& frame, std::string_view interface_name) {
  TextBuffer text;
  append_candump(text, frame, interface_name);
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

TEST(CandumpWriter, WritesLinesOfOneFormOnly) {
  Simulation simulation{reference_run(Load::kLaden, 80.0, 1)};
  SensorNodes nodes{{}, 1};
  for (int i = 0; i < 100; ++i) {
    for (const CanFrame& frame : nodes.pack(simulation.next())) {
      EXPECT_THAT(
          line_of(frame, "can0"),
          ::testing::MatchesRegex("\\([0-9]{10}\\.[0-9]{6}\\) can0 31[012]#[0-9A-F]{6}0[01]\n"));
    }
  }
}

TEST(CsvWriter, WritesTheCanonicalColumns) {
  EXPECT_EQ(kSampleHeader, "time_s,frame_accel_mps2,wheelset1_accel_mps2,wheelset2_accel_mps2\n");
  SimulatedSample sample;
  sample.tick = 1;
  sample.time_s = 1.0 / 300.0;
  sample.accel_mps2 = {0.5, -0.023942, 98.018616};
  TextBuffer text;
  append_csv(text, sample);
  EXPECT_EQ(fmt::to_string(text), "0.003333333,0.500000,-0.023942,98.018616\n");
}

TEST(TruthWriter, HasAColumnForEveryValue) {
  const SimulationConfig config = reference_run(Load::kLaden, 80.0, 1);
  const std::string head = truth_header(config);
  EXPECT_THAT(head, ::testing::HasSubstr("# friction_negative_n = 9150\n"));
  const std::string columns = head.substr(head.rfind("time_s"));
  Simulation simulation{config};
  TextBuffer text;
  append_truth(text, simulation.next());
  EXPECT_EQ(std::ranges::count(columns, ','), std::ranges::count(fmt::to_string(text), ','));
}

TEST(Faults, AreReadFromText) {
  SimulationConfig config;
  TransportConfig transport;
  EXPECT_FALSE(add_fault_text(config, transport, "loss:fraction=0.2"));
  EXPECT_FALSE(add_fault_text(config, transport, "stuck:channel=wheelset2,start_s=5,end_s=6"));
  EXPECT_FALSE(add_fault_text(config, transport, "clipping:channel=frame,range_mps2=1"));
  EXPECT_FALSE(add_fault_text(config, transport, "swap:time_s=3"));
  EXPECT_EQ(transport.loss_fraction, 0.2);
  EXPECT_EQ(transport.swap_time_s, 3.0);
  EXPECT_EQ(config.sensors.stuck_end_s[2], 6.0);
  EXPECT_EQ(config.sensors.range_mps2[0], 1.0);
}

TEST(Faults, AreRefusedWithAReason) {
  SimulationConfig config;
  TransportConfig transport;
  EXPECT_THAT(add_fault_text(config, transport, "fire").value_or(""),
              ::testing::HasSubstr("expected one of loss, swap"));
  EXPECT_THAT(add_fault_text(config, transport, "loss:fraction=1.5").value_or(""),
              ::testing::HasSubstr("expected 0 to 1"));
  EXPECT_THAT(add_fault_text(config, transport, "loss:fraction=nan").value_or(""),
              ::testing::HasSubstr("expected 0 to 1"));
  EXPECT_THAT(add_fault_text(config, transport, "stuck:speed=1").value_or(""),
              ::testing::HasSubstr("unknown parameter 'speed'"));
  EXPECT_EQ(transport.loss_fraction, 0.0);
}

}  // namespace
}  // namespace dampline::sim
