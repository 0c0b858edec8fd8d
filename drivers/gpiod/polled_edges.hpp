// SPDX-License-Identifier: MIT
#pragma once
#include <poll.h>

#include <vector>

#include "drivers/gpiod/edge_ledger.hpp"

namespace dampline::drivers {

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
