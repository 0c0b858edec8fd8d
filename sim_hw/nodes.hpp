// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "dampline/can_frame.hpp"
#include "sim_hw/noise.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::sim {

/// The three sensor nodes: one message each, 4 bytes (dbc/dampline_sensors.dbc).
///   ACCEL_Z 0|12@1-   COUNTER 12|12@1+   STATUS 24|8@1+ (bit 0: full-scale code)
struct NodeConfig {
  std::array<std::uint32_t, kChannels> id{0x310, 0x311, 0x312};
  std::array<std::uint32_t, kExtras> extra_id{0x313, 0x314};
  std::int64_t start_time_ns{1'700'000'000'000'000'000};            ///< of tick 0
  std::array<double, kChannels> arrival_s{0.2e-3, 0.4e-3, 0.6e-3};  ///< after the sampling instant
  double jitter_s{50e-6};  ///< of the arrival, rms, cut off at 90 us
};
inline constexpr std::array<std::string_view, kChannels> kMessageNames{"TRUCK_FRAME", "WHEELSET_1",
                                                                       "WHEELSET_2"};
inline constexpr std::array<std::string_view, kExtras> kExtraMessageNames{"FRAME_END", "FAR_FRAME"};
inline constexpr std::uint32_t kCounterModulus = 4096;

/// Packs samples into frames. Each node counts its own samples from a start that the seed draws.
class SensorNodes {
 public:
  SensorNodes(const NodeConfig& config, std::uint64_t seed);
  /// The frames of one sampling instant in the order of arrival.
  [[nodiscard]] std::array<CanFrame, kChannels> pack(const SimulatedSample& sample) noexcept;
  /// Those of the extra sensors, a little later. They come on time and in order.
  [[nodiscard]] std::array<CanFrame, kExtras> pack_extras(
      const SimulatedSample& sample) const noexcept;

 private:
  [[nodiscard]] CanFrame frame(std::uint32_t id, std::int64_t tick, double delay_s,
                               std::int16_t counts, std::uint32_t first_counter,
                               bool saturated) const noexcept;
  NodeConfig config_;
  Random random_;
  std::array<std::uint32_t, kChannels> first_counter_{};
};

/// The DBC file of the nodes for sensors of these ranges; with `extras`, of the extra sensors too.
[[nodiscard]] std::string dbc_text(const SensorConfig& sensors, const NodeConfig& nodes = {},
                                   bool extras = false);

}  // namespace dampline::sim
