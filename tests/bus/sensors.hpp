// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <vector>

#include "dampline/can_frame.hpp"
#include "dampline/sample.hpp"
#include "tests/bus/bus.hpp"

namespace dampline::bus {

/// Three sensor nodes on a bus, 300 samples a second each, in the format of the project's own DBC,
/// written independently of sim_hw. They know what they sent.
class Sensors {
 public:
  static constexpr std::int64_t kRateHz = 300;
  explicit Sensors(RawSender& bus);

  /// What becomes of a frame on its way; by default it arrives. Any number of frames may come of
  /// it.
  std::function<std::vector<CanFrame>(std::size_t channel, const CanFrame& frame)> fate;
  /// The codes of the next instant; without it any that change.
  std::function<std::array<std::int16_t, kChannels>()> motion;
  /// Instants that go out together, and, where they are several, whole before a reader looks: one
  /// wake-up costs more than many frames.
  std::int64_t batch{1};
  /// Sends at the pace of real sensors.
  void run(std::chrono::duration<double> time);
  /// So many instants at once, and without a pause.
  void burst(std::int64_t instants);
  /// The node counts from 0 again, after not having sent for a while.
  void restart_node(std::size_t channel, std::int64_t instants_off);

  /// Frames that the nodes made, and frames that the kernel did not take.
  [[nodiscard]] std::uint64_t made() const noexcept { return made_; }
  [[nodiscard]] std::uint64_t refused() const noexcept { return refused_; }
  [[nodiscard]] std::int64_t instants() const noexcept { return instant_; }
  [[nodiscard]] CanFrame frame(std::size_t channel) const noexcept;

 private:
  void make_instant(std::vector<CanFrame>& frames);
  RawSender& bus_;
  std::int64_t instant_{0};
  std::chrono::steady_clock::time_point due_{};
  std::array<std::int64_t, kChannels> counter_{1000, 2000, 3000};
  std::array<std::int64_t, kChannels> off_until_{};
  std::array<std::int16_t, kChannels> codes_{};
  std::uint64_t made_{0};
  std::uint64_t refused_{0};
};

}  // namespace dampline::bus
