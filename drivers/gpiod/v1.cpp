// SPDX-License-Identifier: MIT
// libgpiod 1.x (Debian 12). One file descriptor per line; the kernel keeps 16 edges for each, then
// drops the newest and does not tell.
#include <fmt/format.h>
#include <gpiod.h>

#include <array>
#include <cerrno>

#include "drivers/gpiod/edges.hpp"

namespace dampline::drivers {
namespace {

constexpr const char* kConsumer = "dampline";
constexpr std::size_t kKernelQueue = 16;  // edges a line

struct ChipCloser {
  void operator()(gpiod_chip* chip) const noexcept { gpiod_chip_close(chip); }  // its lines too
};
using Chip = std::unique_ptr<gpiod_chip, ChipCloser>;

int request_type(const EdgeLine& line) noexcept {
  if (line.rising && line.falling) return GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES;
  return line.rising ? GPIOD_LINE_REQUEST_EVENT_RISING_EDGE : GPIOD_LINE_REQUEST_EVENT_FALLING_EDGE;
}

/// Null: errno. The chip owns the line.
gpiod_line* request(gpiod_chip* chip, unsigned offset, int type, bool active_low) noexcept {
  gpiod_line* const line = gpiod_chip_get_line(chip, offset);
  if (line == nullptr) return nullptr;
  const gpiod_line_request_config config{
      .consumer = kConsumer,
      .request_type = type,
      .flags = active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0};
  return gpiod_line_request(line, &config, 0) == 0 ? line : nullptr;
}

class EdgesV1 final : public PolledEdges {
 public:
  EdgesV1(const EdgeConfig& config, Chip chip)
      : PolledEdges{config, false}, chip_{std::move(chip)} {}

  /// False: errno.
  [[nodiscard]] bool add(const EdgeLine& line) {
    gpiod_line* const requested =
        request(chip_.get(), line.offset, request_type(line), line.active_low);
    if (requested == nullptr || !watch(gpiod_line_event_get_fd(requested))) return false;
    ++lines_;
    return true;
  }

 private:
  Result<std::size_t> collect(std::span<hal::Edge> out) noexcept override {
    std::size_t used = 0;
    // In turn, so that a busy line cannot keep the others from being read.
    for (std::size_t turn = 0; turn < lines_ && used < out.size(); ++turn) {
      const Result<std::size_t> count = collect_line(next_, out.subspan(used));
      next_ = (next_ + 1) % lines_;
      if (!count.ok() && used == 0) return count;
      if (!count.ok()) break;  // the next call meets the error again
      used += count.value();
    }
    return used;
  }

  Result<std::size_t> collect_line(std::size_t line, std::span<hal::Edge> out) noexcept {
    std::array<gpiod_line_event, kKernelQueue> events{};
    const auto room = static_cast<unsigned>(std::min(out.size(), events.size()));
    const int count = gpiod_line_event_read_fd_multiple(descriptor(line), events.data(), room);
    if (count < 0) return failed(errno);
    const auto edges = static_cast<std::size_t>(count);
    for (std::size_t i = 0; i < edges; ++i) {
      const timespec& time = events[i].ts;  // CLOCK_MONOTONIC since Linux 5.7
      out[i] = enter({.line = static_cast<std::uint8_t>(line),
                      .rising = events[i].event_type == GPIOD_LINE_EVENT_RISING_EDGE,
                      .monotonic_ns = std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec,
                      .number = {}});
    }
    return edges;
  }

  Chip chip_;
  std::size_t lines_{0};
  std::size_t next_{0};
};

class OutputV1 final : public hal::DigitalOutput {
 public:
  OutputV1(Chip chip, gpiod_line* line) : chip_{std::move(chip)}, line_{line} {}

 private:
  Result<bool> do_set(bool active) noexcept override {
    if (gpiod_line_set_value(line_, active ? 1 : 0) < 0) return gpio_error(errno);
    return active;
  }

  Chip chip_;
  gpiod_line* line_;
};

}  // namespace

Outcome<std::unique_ptr<hal::EdgeSource>> open_edges(const EdgeConfig& config) {
  if (std::optional<Failure> failure = check_lines(config)) return *failure;
  Chip chip{gpiod_chip_open(chip_path(config.chip).c_str())};
  if (!chip) return chip_failure(config.chip, errno);
  auto edges = std::make_unique<EdgesV1>(config, std::move(chip));
  for (const EdgeLine& line : config.lines) {
    if (!edges->add(line)) return line_failure(config.chip, line.offset, errno);
  }
  return std::unique_ptr<hal::EdgeSource>{std::move(edges)};
}

Outcome<std::unique_ptr<hal::DigitalOutput>> open_output(const OutputConfig& config) {
  Chip chip{gpiod_chip_open(chip_path(config.chip).c_str())};
  if (!chip) return chip_failure(config.chip, errno);
  gpiod_line* const line =
      request(chip.get(), config.offset, GPIOD_LINE_REQUEST_DIRECTION_OUTPUT, config.active_low);
  if (line == nullptr) return line_failure(config.chip, config.offset, errno);
  return std::unique_ptr<hal::DigitalOutput>{std::make_unique<OutputV1>(std::move(chip), line)};
}

std::string gpio_library() { return fmt::format("libgpiod {}", gpiod_version_string()); }

}  // namespace dampline::drivers
