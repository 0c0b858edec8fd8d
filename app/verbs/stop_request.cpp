// SPDX-License-Identifier: MIT
#include "app/verbs/stop_request.hpp"

namespace dampline::app {
namespace {

volatile std::sig_atomic_t requested = 0;  // NOLINT a signal handler reaches nothing else

extern "C" void request_stop(int /*signal*/) { requested = 1; }

}  // namespace

StopRequest::StopRequest() noexcept {
  requested = 0;
  struct sigaction action {};
  action.sa_handler = request_stop;  // NOLINT a union of the system's
  ::sigemptyset(&action.sa_mask);
  ::sigaction(SIGINT, &action, &before_interrupt_);
  ::sigaction(SIGTERM, &action, &before_terminate_);
}

StopRequest::~StopRequest() {
  ::sigaction(SIGINT, &before_interrupt_, nullptr);
  ::sigaction(SIGTERM, &before_terminate_, nullptr);
}

bool StopRequest::made() const noexcept { return requested != 0; }

}  // namespace dampline::app
