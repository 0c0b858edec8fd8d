// SPDX-License-Identifier: MIT
#include "sim_hw/writers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "sim_hw/faults.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::sim {
namespace {

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
