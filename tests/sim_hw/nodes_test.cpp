// SPDX-License-Identifier: MIT
#include "sim_hw/nodes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <sstream>
#include <vector>

#include "sim_hw/faults.hpp"
#include "sim_hw/simulated_source.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::sim {
namespace {

std::uint32_t word(const CanFrame& frame) {
  std::uint32_t bits = 0;
  for (unsigned i = 0; i < 4; ++i) bits |= static_cast<std::uint32_t>(frame.data[i]) << (8U * i);
  return bits;
}

int accel_counts(const CanFrame& frame) {
  const int raw = static_cast<int>(word(frame) & 0xfffU);
  return raw >= 2048 ? raw - 4096 : raw;
}

std::uint32_t counter(const CanFrame& frame) { return (word(frame) >> 12U) & 0xfffU; }

TEST(SensorNodes, PackCountsThatDecodeBack) {
  Simulation simulation{reference_run(Load::kLaden, 80.0, 1)};
  SensorNodes nodes{{}, 1};
  for (int i = 0; i < 3000; ++i) {
    SimulatedSample sample = simulation.next();
    if (i == 5) sample.counts = {-2048, 2047, -1};
    if (i == 5) sample.saturated = 3;
    for (const CanFrame& frame : nodes.pack(sample)) {
      const std::size_t channel = frame.id - 0x310;
      ASSERT_EQ(accel_counts(frame), sample.counts[channel]);
      ASSERT_EQ(frame.data[3], (sample.saturated >> channel) & 1);
      ASSERT_EQ(frame.length, 4);
      ASSERT_FALSE(frame.extended || frame.fd || frame.remote || frame.error);
    }
  }
}

TEST(SensorNodes, CountEverySampleFromStartsOfTheirOwn) {
  SensorNodes nodes{{}, 11};
  std::map<std::uint32_t, std::uint32_t> last;
  SimulatedSample sample;
  for (std::int64_t i = 0; i < 9000; ++i) {
    sample.tick = i;
    for (const CanFrame& frame : nodes.pack(sample)) {
      if (i > 0) {
        ASSERT_EQ(counter(frame), (last[frame.id] + 1) % 4096);
      }
      last[frame.id] = counter(frame);
    }
  }
  EXPECT_NE(last[0x310], last[0x311]);
  EXPECT_NE(last[0x311], last[0x312]);
}

TEST(SensorNodes, SendInOrderShortlyAfterTheSamplingInstant) {
  SensorNodes nodes{{}, 3};
  SimulatedSample sample;
  double square = 0.0;
  for (std::int64_t i = 0; i < 30000; ++i) {
    sample.tick = i;
    const auto frames = nodes.pack(sample);
    const double sampled = static_cast<double>(i) * 1e9 / 300.0;
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_EQ(frames[c].id, 0x310 + c);
      const double delay =
          static_cast<double>(frames[c].time_ns - 1'700'000'000'000'000'000) - sampled;
      const double jitter = delay - (0.2e6 + 0.2e6 * static_cast<double>(c));
      ASSERT_LE(std::abs(jitter), 90e3 + 1.0);
      square += jitter * jitter / 90000.0;
    }
  }
  EXPECT_NEAR(std::sqrt(square), 45e3, 5e3);
}

TEST(Dbc, InTheRepositoryIsThatOfTheDefaultSensors) {
  std::ifstream file{DAMPLINE_SOURCE_DIR "/sim_hw/dbc/dampline_sensors.dbc"};
  ASSERT_TRUE(file);
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), dbc_text({}));
  EXPECT_THAT(
      text.str(),
      ::testing::HasSubstr(
          "BO_ 784 TRUCK_FRAME: 4 FRAME_NODE\n SG_ ACCEL_Z : 0|12@1- (0.0239420166015625,0) "
          "[-49.03325|49.00930798339844] \"m/s^2\" LOGGER\n"));
}

TEST(Dbc, FollowsTheRangeOfTheSensors) {
  SensorConfig sensors;
  sensors.range_mps2[1] = 2048.0;
  EXPECT_THAT(dbc_text(sensors), ::testing::HasSubstr("(1,0) [-2048|2047] \"m/s^2\""));
}

/// The frames of a run of `ticks` instants through a transport.
std::vector<CanFrame> carried(const TransportConfig& config, std::int64_t ticks) {
  SensorNodes nodes{{}, 1};
  Transport transport{config, 1};
  std::vector<CanFrame> out;
  SimulatedSample sample;
  for (std::int64_t i = 0; i < ticks; ++i) {
    sample.tick = i;
    sample.time_s = static_cast<double>(i) / 300.0;
    const auto frames = transport.pass(nodes.pack(sample), sample.time_s);
    out.insert(out.end(), frames.begin(), frames.end());
  }
  return out;
}

bool is_ordered(const std::vector<CanFrame>& frames) {
  return std::ranges::is_sorted(frames, {}, &CanFrame::time_ns);
}

TEST(Transport, PassesEverythingWhenNothingIsWrong) {
  const auto frames = carried({}, 1000);
  EXPECT_EQ(frames.size(), 3000U);
  EXPECT_TRUE(is_ordered(frames));
}

TEST(Transport, LosesTheWantedFraction) {
  const auto frames = carried({.loss_fraction = 0.05}, 20000);
  EXPECT_NEAR(static_cast<double>(frames.size()), 57000.0, 250.0);
  EXPECT_TRUE(is_ordered(frames));
}

TEST(Transport, SwapsTwoFramesOfOneMessage) {
  const auto frames = carried({.swap_time_s = 1.0}, 600);
  EXPECT_EQ(frames.size(), 1800U);
  EXPECT_TRUE(is_ordered(frames));
  std::vector<std::uint32_t> counters;
  for (const CanFrame& frame : frames) {
    if (frame.id == 0x310) counters.push_back(counter(frame));
  }
  int backward = 0;
  for (std::size_t i = 1; i < counters.size(); ++i) {
    const std::uint32_t step = (counters[i] + 4096 - counters[i - 1]) % 4096;
    if (step == 4095) {
      EXPECT_EQ(i, 301U);
      ++backward;
    }
  }
  EXPECT_EQ(backward, 1);
}

TEST(Transport, KeepsTheOrderOfTimeWhateverItSwaps) {
  const auto frames = carried({.loss_fraction = 0.1, .swap_fraction = 0.3}, 5000);
  EXPECT_TRUE(is_ordered(frames));
  EXPECT_GT(frames.size(), 13000U);
}

TEST(SimulatedSource, DeliversTheSameFramesInPiecesOfAnySize) {
  const SimulationConfig config = reference_run(Load::kEmpty, 60.0, 2);
  SimulatedSource whole{config, 100};
  SimulatedSource pieces{config, 100};
  std::array<CanFrame, 300> all{};
  ASSERT_EQ(whole.read(all).value(), 300U);
  for (std::size_t done = 0; done < 300;) {
    std::array<CanFrame, 7> some{};
    const std::size_t count = pieces.read(some).value();
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(some[i].time_ns, all[done + i].time_ns);
      EXPECT_EQ(some[i].data, all[done + i].data);
    }
    done += count;
  }
  EXPECT_EQ(pieces.health().frames, 300U);
  EXPECT_EQ(pieces.last_sample().tick, 99);
  EXPECT_EQ(pieces.read(all).error(), Errc::kEndOfStream);
  EXPECT_EQ(pieces.read(all).error(), Errc::kEndOfStream);
}

}  // namespace
}  // namespace dampline::sim
