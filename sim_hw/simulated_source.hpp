// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "hal/frame_source.hpp"
#include "sim_hw/faults.hpp"
#include "sim_hw/nodes.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::sim {

/// The simulated sensors as a source of frames, as fast as it is read. Ends after `samples`.
class SimulatedSource final : public hal::FrameSource {
 public:
  SimulatedSource(const SimulationConfig& simulation, std::int64_t samples,
                  const NodeConfig& nodes = {}, const TransportConfig& transport = {});
  /// The sample whose frames were delivered last, for its truth.
  [[nodiscard]] const SimulatedSample& last_sample() const noexcept { return last_; }

 private:
  [[nodiscard]] Result<std::size_t> do_read(std::span<CanFrame> out) noexcept override;
  [[nodiscard]] Result<bool> do_wait(std::chrono::nanoseconds /*timeout*/) noexcept override {
    return true;
  }
  [[nodiscard]] hal::SourceHealth do_health() const noexcept override { return health_; }

  Simulation simulation_;
  SensorNodes nodes_;
  Transport transport_;
  std::int64_t remaining_;
  SimulatedSample last_{};
  std::span<const CanFrame> pending_;
  hal::SourceHealth health_{};
};

}  // namespace dampline::sim
