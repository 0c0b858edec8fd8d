// SPDX-License-Identifier: MIT
#include "drivers/gpiod/polled_edges.hpp"

#include <fcntl.h>

#include <algorithm>
#include <cerrno>
#include <ctime>

#include "drivers/gpiod/gpio_text.hpp"

namespace dampline::drivers {

PolledEdges::PolledEdges(const EdgeConfig& config, bool numbered) : ledger_{config, numbered} {
  polls_.reserve(config.lines.size());
}

bool PolledEdges::watch(int descriptor) {
  if (descriptor < 0) return false;
  const int flags = ::fcntl(descriptor, F_GETFL);
  if (flags < 0 || ::fcntl(descriptor, F_SETFL, flags | O_NONBLOCK) < 0) return false;
  polls_.push_back({.fd = descriptor, .events = POLLIN, .revents = 0});
  return true;
}

Result<std::size_t> PolledEdges::failed(int error) noexcept {
  if (error == EAGAIN || error == EINTR) return std::size_t{0};
  gone_ = gpio_error(error) == Errc::kLinkDown;
  return gpio_error(error);
}

Result<std::size_t> PolledEdges::do_read(std::span<hal::Edge> out) noexcept {
  if (gone_) return Errc::kLinkDown;
  if (out.empty()) return std::size_t{0};
  return collect(out);
}

Result<bool> PolledEdges::do_wait(std::chrono::nanoseconds timeout) noexcept {
  if (gone_) return true;
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(timeout);
  const timespec limit{.tv_sec = std::max<std::int64_t>(0, seconds.count()),
                       .tv_nsec = std::max<std::int64_t>(0, (timeout - seconds).count())};
  const int ready = ::ppoll(polls_.data(), polls_.size(), &limit, nullptr);
  if (ready < 0) return errno == EINTR ? Result<bool>{false} : Errc::kIo;  // a signal: look again
  return ready > 0;
}

}  // namespace dampline::drivers
