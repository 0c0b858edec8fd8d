// SPDX-License-Identifier: MIT
#pragma once
#include <csignal>

namespace dampline::app {

/// While it lives, SIGINT and SIGTERM ask for an end instead of forcing one; sleeps are cut short
/// by them. One at a time.
class StopRequest {
 public:
  StopRequest() noexcept;
  StopRequest(const StopRequest&) = delete;
  StopRequest& operator=(const StopRequest&) = delete;
  ~StopRequest();
  [[nodiscard]] bool made() const noexcept;

 private:
  struct sigaction before_interrupt_ {};
  struct sigaction before_terminate_ {};
};

}  // namespace dampline::app
