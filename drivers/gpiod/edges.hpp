// SPDX-License-Identifier: MIT
#pragma once
#include <poll.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/gpiod/lines.hpp"

namespace dampline::drivers {

/// "gpiochip0" is short for "/dev/gpiochip0".
[[nodiscard]] std::string chip_path(const std::string& chip);
/// What no library needs to be asked for.
[[nodiscard]] std::optional<Failure> check_lines(const EdgeConfig& config);
/// The chip could not be opened; `error` is errno.
[[nodiscard]] Failure chip_failure(const std::string& chip, int error);
/// A line of it could not be had.
[[nodiscard]] Failure line_failure(const std::string& chip, unsigned offset, int error);
[[nodiscard]] Errc gpio_error(int error) noexcept;

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

/// What both versions of the library share: waiting, the books, and a chip that is gone for good.
class PolledEdges : public hal::EdgeSource {
 protected:
  PolledEdges(const EdgeConfig& config, bool numbered);
  /// Adds a file descriptor to wait for and makes it one that does not block. False: errno.
  [[nodiscard]] bool watch(int descriptor);
  [[nodiscard]] int descriptor(std::size_t index) const noexcept { return polls_[index].fd; }
  [[nodiscard]] hal::Edge enter(const KernelEdge& edge) noexcept { return ledger_.enter(edge); }
  /// What a failed read means: nothing there yet, the chip is gone, or an error.
  [[nodiscard]] Result<std::size_t> failed(int error) noexcept;

 private:
  [[nodiscard]] virtual Result<std::size_t> collect(std::span<hal::Edge> out) noexcept = 0;
  Result<std::size_t> do_read(std::span<hal::Edge> out) noexcept final;
  Result<bool> do_wait(std::chrono::nanoseconds timeout) noexcept final;
  [[nodiscard]] hal::EdgeHealth do_health() const noexcept final { return ledger_.health(); }

  EdgeLedger ledger_;
  std::vector<pollfd> polls_;
  bool gone_{false};
};

}  // namespace dampline::drivers
