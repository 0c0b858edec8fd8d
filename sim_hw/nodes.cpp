// SPDX-License-Identifier: MIT
#include "sim_hw/nodes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace dampline::sim {

SensorNodes::SensorNodes(const NodeConfig& config, std::uint64_t seed)
    : config_(config), random_(seed, Stream::kNodes) {
  for (std::uint32_t& first : first_counter_) {
    first = static_cast<std::uint32_t>(random_.bits() % kCounterModulus);
  }
}

std::array<CanFrame, kChannels> SensorNodes::pack(const SimulatedSample& sample) noexcept {
  constexpr double kLargestJitterS = 90e-6;
  // 10^9 / 300 ns per tick, without rounding that adds up
  const std::int64_t sampled_ns = config_.start_time_ns + sample.tick * 10'000'000 / 3;
  std::array<CanFrame, kChannels> frames{};
  for (std::size_t c = 0; c < kChannels; ++c) {
    const double jitter_s =
        std::clamp(config_.jitter_s * random_.normal(), -kLargestJitterS, kLargestJitterS);
    const auto accel = static_cast<std::uint32_t>(sample.counts[c]) & 0xfffU;
    const auto counter = static_cast<std::uint32_t>(
        (static_cast<std::uint64_t>(sample.tick) + first_counter_[c]) % kCounterModulus);
    CanFrame& frame = frames[c];
    frame.time_ns = sampled_ns + std::llround((config_.arrival_s[c] + jitter_s) * 1e9);
    frame.id = config_.id[c];
    frame.length = 4;
    frame.data[0] = static_cast<std::uint8_t>(accel & 0xffU);
    frame.data[1] = static_cast<std::uint8_t>((accel >> 8U) | ((counter & 0xfU) << 4U));
    frame.data[2] = static_cast<std::uint8_t>(counter >> 4U);
    frame.data[3] = static_cast<std::uint8_t>((sample.saturated >> c) & 1U);
  }
  std::ranges::stable_sort(frames, {}, &CanFrame::time_ns);
  return frames;
}

namespace {

constexpr std::array<std::string_view, kChannels> kPlaces{
    "truck frame above the centre of the bogie", "leading wheelset, axle box",
    "trailing wheelset, axle box"};

constexpr std::string_view kHead = R"(VERSION "1"

NS_ :
	CM_
	BA_DEF_
	BA_
	VAL_
	BA_DEF_DEF_

BS_:

BU_: FRAME_NODE WHEELSET_1_NODE WHEELSET_2_NODE LOGGER

)";

constexpr std::array<std::string_view, kChannels> kNodes{"FRAME_NODE", "WHEELSET_1_NODE",
                                                         "WHEELSET_2_NODE"};

}  // namespace

std::string dbc_text(const SensorConfig& sensors, const NodeConfig& nodes) {
  std::string text{kHead};
  auto out = std::back_inserter(text);
  for (std::size_t c = 0; c < kChannels; ++c) {
    const double scale = count_scale_mps2(sensors.range_mps2[c]);
    fmt::format_to(out, "BO_ {} {}: 4 {}\n", nodes.id[c], kMessageNames[c], kNodes[c]);
    fmt::format_to(out, " SG_ ACCEL_Z : 0|12@1- ({},0) [{}|{}] \"m/s^2\" LOGGER\n", scale,
                   kMinCount * scale, kMaxCount * scale);
    fmt::format_to(out, " SG_ COUNTER : 12|12@1+ (1,0) [0|4095] \"\" LOGGER\n");
    fmt::format_to(out, " SG_ STATUS : 24|8@1+ (1,0) [0|255] \"\" LOGGER\n\n");
  }
  fmt::format_to(out,
                 "CM_ \"Three accelerometers of a freight-car truck, 300 samples a second.\";\n");
  for (std::size_t c = 0; c < kChannels; ++c) {
    const auto id = nodes.id[c];
    fmt::format_to(out, "CM_ BO_ {} \"One sample: {}.\";\n", id, kPlaces[c]);
    fmt::format_to(out, "CM_ SG_ {} ACCEL_Z \"Vertical acceleration, up is positive.\";\n", id);
    fmt::format_to(out, "CM_ SG_ {} COUNTER \"Counts the samples of this node, modulo 4096.\";\n",
                   id);
    fmt::format_to(out, "CM_ SG_ {} STATUS \"Bit 0: ACCEL_Z stands at a full-scale code.\";\n", id);
  }
  fmt::format_to(out, "BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 65535;\n");
  fmt::format_to(out, "BA_DEF_DEF_ \"GenMsgCycleTime\" 0;\n");
  return text;
}

}  // namespace dampline::sim
