// SPDX-License-Identifier: MIT
#include "drivers/gpiod/edges.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>

namespace dampline::drivers {
namespace {

constexpr std::size_t kMostLines = 64;  // of one chip at once, in both versions of the library

Failure wrong(const std::string& text) { return {Errc::kInvalidConfig, text}; }

const char* advice(int error) {
  if (error == EBUSY) return "somebody else has it, expected a free line; `gpioinfo` says who";
  if (error == EINVAL) return "expected a line that the chip has; `gpioinfo` lists them";
  if (error == ENXIO) return "expected a line that can raise interrupts";
  return "expected a line that can be requested";
}

}  // namespace

std::string chip_path(const std::string& chip) {
  return chip.starts_with('/') ? chip : "/dev/" + chip;
}

std::optional<Failure> check_lines(const EdgeConfig& config) {
  if (config.lines.empty()) return wrong("no GPIO line is named, expected at least one");
  if (config.lines.size() > kMostLines) {
    return wrong(fmt::format("{}: {} lines, expected at most {}", config.chip, config.lines.size(),
                             kMostLines));
  }
  for (std::size_t i = 0; i < config.lines.size(); ++i) {
    const EdgeLine& line = config.lines[i];
    if (!line.rising && !line.falling) {
      return wrong(fmt::format("{} line {}: no edge is watched, expected rising, falling or both",
                               config.chip, line.offset));
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (config.lines[j].offset != line.offset) continue;
      return wrong(fmt::format("{} line {}: named twice, expected once", config.chip, line.offset));
    }
  }
  return std::nullopt;
}

Failure chip_failure(const std::string& chip, int error) {
  return {gpio_error(error),
          fmt::format("{}: {}; expected a GPIO chip that may be opened (`gpiodetect` lists them)",
                      chip_path(chip), std::strerror(error))};
}

Failure line_failure(const std::string& chip, unsigned offset, int error) {
  return {gpio_error(error), fmt::format("{} line {}: {}; {}", chip_path(chip), offset,
                                         std::strerror(error), advice(error))};
}

Errc gpio_error(int error) noexcept { return error == ENODEV ? Errc::kLinkDown : Errc::kIo; }

EdgeLedger::EdgeLedger(const EdgeConfig& config, bool numbered) : run_time_{config.run_time} {
  lines_.reserve(config.lines.size());
  for (const EdgeLine& line : config.lines) {
    lines_.push_back({.alternates = line.rising && line.falling});
  }
  if (numbered) health_.lost = 0;
}

std::uint32_t EdgeLedger::lost_before(const Line& line, const KernelEdge& edge) noexcept {
  if (!edge.number) return 0;
  const std::uint32_t gap = *edge.number - line.number - 1;  // modulo 2^32, as the kernel counts
  constexpr std::uint32_t kHalf = 1U << 31U;
  return gap < kHalf ? gap : 0;  // a number that stands still or goes back tells of no loss
}

hal::Edge EdgeLedger::enter(const KernelEdge& edge) noexcept {
  Line& line = lines_[edge.line];
  const std::uint32_t lost = lost_before(line, edge);
  // Lost edges alternated too: their number says which one must follow.
  const bool expected = (lost % 2 == 0) != line.rising;
  const bool impossible = line.alternates && line.seen && edge.rising != expected;
  if (line.seen && edge.monotonic_ns < line.monotonic_ns) ++health_.reordered;
  const std::int64_t time_ns =
      line.seen ? std::max(line.monotonic_ns, edge.monotonic_ns) : edge.monotonic_ns;

  ++health_.edges;
  if (impossible) ++health_.impossible;
  if (health_.lost) *health_.lost += lost;
  line.seen = true;
  line.rising = edge.rising;
  line.monotonic_ns = time_ns;
  if (edge.number) line.number = *edge.number;
  return {.time_ns = run_time_.from_monotonic(time_ns),
          .line = edge.line,
          .rising = edge.rising,
          .impossible = impossible,
          .lost_before = lost};
}

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
