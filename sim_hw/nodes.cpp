// SPDX-License-Identifier: MIT
#include "sim_hw/nodes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

namespace dampline::sim {

SensorNodes::SensorNodes(const NodeConfig& config, std::uint64_t seed)
    : config_(config), random_(seed, Stream::kNodes) {
  for (std::uint32_t& first : first_counter_) {
    first = static_cast<std::uint32_t>(random_.bits() % kCounterModulus);
  }
}

CanFrame SensorNodes::frame(std::uint32_t id, std::int64_t tick, double delay_s,
                            std::int16_t counts, std::uint32_t first_counter,
                            bool saturated) const noexcept {
  // 10^9 / 300 ns per tick, without rounding that adds up
  const std::int64_t sampled_ns = config_.start_time_ns + tick * 10'000'000 / 3;
  const auto accel = static_cast<std::uint32_t>(counts) & 0xfffU;
  const auto counter = static_cast<std::uint32_t>(
      (static_cast<std::uint64_t>(tick) + first_counter) % kCounterModulus);
  CanFrame out{};
  out.time_ns = sampled_ns + std::llround(delay_s * 1e9);
  out.id = id;
  out.length = 4;
  out.data[0] = static_cast<std::uint8_t>(accel & 0xffU);
  out.data[1] = static_cast<std::uint8_t>((accel >> 8U) | ((counter & 0xfU) << 4U));
  out.data[2] = static_cast<std::uint8_t>(counter >> 4U);
  out.data[3] = saturated ? 1 : 0;
  return out;
}

std::array<CanFrame, kChannels> SensorNodes::pack(const SimulatedSample& sample) noexcept {
  constexpr double kLargestJitterS = 90e-6;
  std::array<CanFrame, kChannels> frames{};
  for (std::size_t c = 0; c < kChannels; ++c) {
    const double jitter_s =
        std::clamp(config_.jitter_s * random_.normal(), -kLargestJitterS, kLargestJitterS);
    frames[c] = frame(config_.id[c], sample.tick, config_.arrival_s[c] + jitter_s, sample.counts[c],
                      first_counter_[c], (sample.saturated >> c & 1U) != 0);
  }
  std::ranges::stable_sort(frames, {}, &CanFrame::time_ns);
  return frames;
}

std::array<CanFrame, kExtras> SensorNodes::pack_extras(
    const SimulatedSample& sample) const noexcept {
  constexpr double kApartS = 0.2e-3;
  std::array<CanFrame, kExtras> frames{};
  for (std::size_t e = 0; e < kExtras; ++e) {
    const double delay_s = config_.arrival_s.back() + kApartS * static_cast<double>(e + 1);
    frames[e] = frame(config_.extra_id[e], sample.tick, delay_s, sample.extra_counts[e],
                      first_counter_[0], (sample.saturated >> (kChannels + e) & 1U) != 0);
  }
  return frames;
}

namespace {

constexpr std::array<std::string_view, kChannels> kPlaces{
    "truck frame above the centre of the bogie", "leading wheelset, axle box",
    "trailing wheelset, axle box"};

constexpr std::array<std::string_view, kExtras> kExtraNodes{"FRAME_END_NODE", "FAR_FRAME_NODE"};
constexpr std::array<std::string_view, kExtras> kExtraPlaces{
    "truck frame above the leading wheelset", "frame of the other truck, or the body above it"};

constexpr std::string_view kHead = R"(VERSION "1"

NS_ :
	CM_
	BA_DEF_
	BA_
	VAL_
	BA_DEF_DEF_

BS_:

)";

constexpr std::array<std::string_view, kChannels> kNodes{"FRAME_NODE", "WHEELSET_1_NODE",
                                                         "WHEELSET_2_NODE"};

struct NodeText {
  std::uint32_t id;
  std::string_view message, node, place;
  double range_mps2;
};

std::vector<NodeText> node_texts(const SensorConfig& sensors, const NodeConfig& nodes,
                                 bool extras) {
  std::vector<NodeText> out;
  for (std::size_t c = 0; c < kChannels; ++c)
    out.push_back({nodes.id[c], kMessageNames[c], kNodes[c], kPlaces[c], sensors.range_mps2[c]});
  for (std::size_t e = 0; extras && e < kExtras; ++e)
    out.push_back({nodes.extra_id[e], kExtraMessageNames[e], kExtraNodes[e], kExtraPlaces[e],
                   sensors.range_mps2[0]});
  return out;
}

}  // namespace

std::string dbc_text(const SensorConfig& sensors, const NodeConfig& nodes, bool extras) {
  const std::vector<NodeText> all = node_texts(sensors, nodes, extras);
  std::string text{kHead};
  auto out = std::back_inserter(text);
  text += "BU_:";
  for (const NodeText& node : all) fmt::format_to(out, " {}", node.node);
  text += " LOGGER\n\n";
  for (const NodeText& node : all) {
    const double scale = count_scale_mps2(node.range_mps2);
    fmt::format_to(out, "BO_ {} {}: 4 {}\n", node.id, node.message, node.node);
    fmt::format_to(out, " SG_ ACCEL_Z : 0|12@1- ({},0) [{}|{}] \"m/s^2\" LOGGER\n", scale,
                   kMinCount * scale, kMaxCount * scale);
    fmt::format_to(out, " SG_ COUNTER : 12|12@1+ (1,0) [0|4095] \"\" LOGGER\n");
    fmt::format_to(out, " SG_ STATUS : 24|8@1+ (1,0) [0|255] \"\" LOGGER\n\n");
  }
  fmt::format_to(out, "CM_ \"{} accelerometers of a freight-car truck, 300 samples a second.\";\n",
                 extras ? "Five" : "Three");
  for (const NodeText& node : all) {
    const auto id = node.id;
    fmt::format_to(out, "CM_ BO_ {} \"One sample: {}.\";\n", id, node.place);
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
