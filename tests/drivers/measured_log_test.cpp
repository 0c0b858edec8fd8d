// SPDX-License-Identifier: MIT
// The measured candump log through driver, DBC and assembler, against what its NOTES.txt says.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>
#include <vector>

#include "dampline/guard/guard.hpp"
#include "dampline/sample/assembler.hpp"
#include "drivers/candump/source.hpp"
#include "drivers/dbc/channel.hpp"
#include "temporary_file.hpp"
#include "tests/shared_data.hpp"

namespace dampline::drivers {
namespace {

class MeasuredLog : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto folder = test::shared_data() / "can_log";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "measured data not found: " << folder;
    dbc_ = load_dbc((folder / "sample_can_spec.dbc").string()).value();
    auto source = CandumpSource::open({.path = (folder / "can_sample.log").string()});
    frames_.resize(100'000);
    frames_.resize(source.value()->read(frames_).value());
  }
  AssemblerConfig accelerations() const {
    AssemblerConfig config;
    config.sample_rate_hz = 50.0;
    config.channels[0] = channel_from(dbc_, "ID_D0.ACCEL_LAT", "").value();
    config.channels[1] = config.channels[2] = channel_from(dbc_, "ID_D0.ACCEL_LONG", "").value();
    return SampleAssembler::check(config).value();
  }
  std::vector<Sample> assemble(SampleAssembler& assembler) const {
    std::vector<Sample> samples;
    Sample sample;
    for (const CanFrame& frame : frames_) {
      assembler.push(frame);
      while (assembler.pop(sample)) samples.push_back(sample);
    }
    assembler.flush();
    while (assembler.pop(sample)) samples.push_back(sample);
    return samples;
  }
  Dbc dbc_;
  std::vector<CanFrame> frames_;
};

TEST_F(MeasuredLog, HasTheStatedFramesIdentifiersAndRange) {
  EXPECT_EQ(frames_.size(), 82558U);
  std::set<std::uint32_t> ids;
  std::vector<double> lateral;
  std::vector<double> longitudinal;
  std::vector<std::int64_t> times_ns;
  const SignalLayout lat = find_signal(dbc_, "ID_D0.ACCEL_LAT").value().signal->layout;
  const SignalLayout lon = find_signal(dbc_, "ID_D0.ACCEL_LONG").value().signal->layout;
  for (const CanFrame& frame : frames_) {
    ids.insert(frame.id);
    if (frame.id != 0x0D0) continue;
    lateral.push_back(extract_physical(lat, frame).value());
    longitudinal.push_back(extract_physical(lon, frame).value());
    times_ns.push_back(frame.time_ns);
  }
  EXPECT_EQ(ids.size(), 35U);
  ASSERT_EQ(times_ns.size(), 4514U);
  EXPECT_NEAR(*std::min_element(lateral.begin(), lateral.end()), -2.4, 1e-9);
  EXPECT_NEAR(*std::max_element(lateral.begin(), lateral.end()), 1.4, 1e-9);
  EXPECT_NEAR(*std::min_element(longitudinal.begin(), longitudinal.end()), -5.55, 1e-9);
  EXPECT_NEAR(*std::max_element(longitudinal.begin(), longitudinal.end()), 1.8, 1e-9);
  std::int64_t shortest_ns = 1'000'000'000;
  std::int64_t longest_ns = 0;
  for (std::size_t i = 1; i < times_ns.size(); ++i) {
    shortest_ns = std::min(shortest_ns, times_ns[i] - times_ns[i - 1]);
    longest_ns = std::max(longest_ns, times_ns[i] - times_ns[i - 1]);
  }
  // NOTES.txt says 19.0; the times of the file, subtracted by hand, say 18.741.
  EXPECT_EQ(shortest_ns, 18'741'000);
  EXPECT_EQ(longest_ns, 21'275'000);
  EXPECT_NEAR(static_cast<double>(times_ns.back() - times_ns.front()) * 1e-9, 90.26, 0.005);
}

TEST_F(MeasuredLog, AssemblesIntoSamplesWithoutAGapAtItsOwnRate) {
  SampleAssembler assembler{accelerations()};
  EXPECT_FALSE(accelerations().channels[0].has_counter);
  const std::vector<Sample> samples = assemble(assembler);
  ASSERT_EQ(samples.size(), 4514U);
  EXPECT_EQ(samples.back().tick - samples.front().tick, 4513);
  EXPECT_EQ(assembler.counts().foreign, 82558U - 4514U);
  EXPECT_EQ(assembler.counts().channels[0].gaps, 0U);
  EXPECT_EQ(assembler.counts().channels[0].saturated, 0U);
  EXPECT_NEAR(assembler.measured_rate().rate_hz, 50.0, 0.005);
}

/// Eight bits of a road car, its frames at 50 Hz: coarse, but sound.
TEST_F(MeasuredLog, HasNoFaultThatTheGuardsSee) {
  GuardConfig config;
  config.sample_rate_hz = 50.0;
  for (const bool declared : {false, true}) {
    if (declared) config.step_mps2 = {0.2, 0.15, 0.15};
    const auto guard = std::make_unique<Guard>(Guard::check(config).value());
    SampleAssembler fresh{accelerations()};
    for (const Sample& sample : assemble(fresh)) guard->update(sample);
    guard->finish();
    for (const Fault& fault : guard->faults()) {
      if (fault.kind == FaultKind::kIdenticalChannels) continue;  // one signal for both wheelsets
      ADD_FAILURE() << name_of(fault.kind) << ' ' << name_of(fault.channel) << " at "
                    << fault.time_s << " s, " << fault.size << ' ' << fault.unit << " x "
                    << fault.count;
    }
  }
}

}  // namespace
}  // namespace dampline::drivers
