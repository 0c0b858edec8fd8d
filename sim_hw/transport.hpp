// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dampline/can_frame.hpp"
#include "sim_hw/random.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::sim {

/// What a bus or a logger does wrong.
struct TransportConfig {
  double loss_fraction{0.0};  ///< of the frames, each by itself
  double swap_fraction{0.0};  ///< of the frames: arrive after the next frame of their message
  double swap_time_s{-1.0};   ///< one swap of the frame channel at this time; negative: none
};

/// At most this many frames leave per sampling instant: each node's own and one that was held.
inline constexpr std::size_t kMaxFramesPerTick = 2 * kChannels;

class Transport {
 public:
  Transport(const TransportConfig& config, std::uint64_t seed);
  /// Takes the frames of one instant, gives those that arrive now, in the order of arrival.
  /// The span is valid until the next call.
  [[nodiscard]] std::span<const CanFrame> pass(const std::array<CanFrame, kChannels>& frames,
                                               double time_s) noexcept;

 private:
  struct Held {
    bool full{false};
    CanFrame frame{};
  };
  [[nodiscard]] Held* held_for(std::uint32_t id) noexcept;
  [[nodiscard]] bool swaps(std::size_t position, double time_s) noexcept;
  void emit(const CanFrame& frame) noexcept { out_[count_++] = frame; }
  TransportConfig config_;
  Random random_;
  bool swap_done_;
  bool active_;
  std::array<Held, kChannels> held_{};
  std::array<CanFrame, kMaxFramesPerTick> out_{};
  std::size_t count_{0};
};

}  // namespace dampline::sim
