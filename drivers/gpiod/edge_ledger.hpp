// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "drivers/gpiod/gpiod.hpp"

namespace dampline::drivers {

/// An edge as the kernel tells it.
struct KernelEdge {
  std::uint8_t line{0};  ///< index among the lines of the configuration
  bool rising{false};
  std::int64_t monotonic_ns{0};
  std::optional<std::uint32_t> number;  ///< of this line, from 1; absent with libgpiod 1
};

/// Keeps the books of every line: no time goes back, both edges alternate, numbers leave no gap.
/// All memory is taken at construction.
class EdgeLedger {
 public:
  explicit EdgeLedger(const EdgeConfig& config, bool numbered);
  /// Precondition: edge.line is one of the configuration.
  [[nodiscard]] hal::Edge enter(const KernelEdge& edge) noexcept;
  [[nodiscard]] const hal::EdgeHealth& health() const noexcept { return health_; }

 private:
  struct Line {
    bool alternates{false};  ///< both edges are watched
    bool seen{false};
    bool rising{false};  ///< the last edge
    std::int64_t monotonic_ns{0};
    std::uint32_t number{0};
  };
  [[nodiscard]] static std::uint32_t lost_before(const Line& line, const KernelEdge& edge) noexcept;

  hal::RunTime run_time_;
  std::vector<Line> lines_;
  hal::EdgeHealth health_;
};

}  // namespace dampline::drivers
