// SPDX-License-Identifier: MIT
#pragma once
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "dampline/result.hpp"

namespace dampline::hal {

struct Edge {
  std::int64_t time_ns{0};  ///< run time, from the kernel's stamp
  std::uint8_t line{0};     ///< index among the lines that were asked for
  bool rising{false};       ///< inactive to active
  bool impossible{false};   ///< the edge before had this direction too, though both are watched
  std::uint32_t lost_before{0};  ///< edges of this line known to be lost just before
};

/// Monotone counters.
struct EdgeHealth {
  std::uint64_t edges{0};             ///< delivered
  std::uint64_t impossible{0};        ///< a second edge of one direction where both are watched
  std::uint64_t reordered{0};         ///< earlier than the edge before; its time was held
  std::optional<std::uint64_t> lost;  ///< absent: the library cannot tell (libgpiod 1)
};

/// Edges of digital inputs: a pulse per second, a marker, a wheel pulse.
/// Contract:
///  - read() never blocks and never allocates; 0 edges is success
///  - edges of one line arrive in non-decreasing time_ns
///  - after kLinkDown (the chip is gone) every later read() is kLinkDown
class EdgeSource {
 public:
  EdgeSource() = default;
  EdgeSource(const EdgeSource&) = delete;
  EdgeSource& operator=(const EdgeSource&) = delete;
  virtual ~EdgeSource() = default;
  [[nodiscard]] Result<std::size_t> read(std::span<Edge> out) noexcept { return do_read(out); }
  /// True when read() will deliver or report something; false after `timeout`.
  [[nodiscard]] Result<bool> wait(std::chrono::nanoseconds timeout) noexcept {
    return do_wait(timeout);
  }
  [[nodiscard]] EdgeHealth health() const noexcept { return do_health(); }

 private:
  virtual Result<std::size_t> do_read(std::span<Edge> out) noexcept = 0;
  virtual Result<bool> do_wait(std::chrono::nanoseconds timeout) noexcept = 0;
  [[nodiscard]] virtual EdgeHealth do_health() const noexcept = 0;
};

}  // namespace dampline::hal
