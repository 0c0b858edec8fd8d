// SPDX-License-Identifier: MIT
// libgpiod 2.x. One request for all lines; the kernel drops the oldest edges when its queue is
// full, and the numbers of the others tell how many.
#include <fmt/format.h>
#include <gpiod.h>

#include <algorithm>
#include <cerrno>

#include "drivers/gpiod/edges.hpp"

namespace dampline::drivers {
namespace {

constexpr const char* kConsumer = "dampline";
constexpr std::size_t kKernelQueue = 1024;  // edges; the most that the kernel gives
constexpr std::size_t kReadAtOnce = 64;     // edges; the library clears so many for every read

template <auto Free>
struct Freer {
  template <class T>
  void operator()(T* object) const noexcept {
    Free(object);
  }
};
using Chip = std::unique_ptr<gpiod_chip, Freer<gpiod_chip_close>>;
using Settings = std::unique_ptr<gpiod_line_settings, Freer<gpiod_line_settings_free>>;
using Lines = std::unique_ptr<gpiod_line_config, Freer<gpiod_line_config_free>>;
using Wishes = std::unique_ptr<gpiod_request_config, Freer<gpiod_request_config_free>>;
using Request = std::unique_ptr<gpiod_line_request, Freer<gpiod_line_request_release>>;
using Buffer = std::unique_ptr<gpiod_edge_event_buffer, Freer<gpiod_edge_event_buffer_free>>;

gpiod_line_edge edge_of(const EdgeLine& line) noexcept {
  if (line.rising && line.falling) return GPIOD_LINE_EDGE_BOTH;
  return line.rising ? GPIOD_LINE_EDGE_RISING : GPIOD_LINE_EDGE_FALLING;
}

/// False: errno.
bool add_input(gpiod_line_config& lines, const EdgeLine& line) noexcept {
  const Settings settings{gpiod_line_settings_new()};
  if (!settings) return false;
  gpiod_line_settings_set_active_low(settings.get(), line.active_low);
  return gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_INPUT) == 0 &&
         gpiod_line_settings_set_edge_detection(settings.get(), edge_of(line)) == 0 &&
         gpiod_line_settings_set_event_clock(settings.get(), GPIOD_LINE_CLOCK_MONOTONIC) == 0 &&
         gpiod_line_config_add_line_settings(&lines, &line.offset, 1, settings.get()) == 0;
}

bool add_output(gpiod_line_config& lines, const OutputConfig& output) noexcept {
  const Settings settings{gpiod_line_settings_new()};
  if (!settings) return false;
  gpiod_line_settings_set_active_low(settings.get(), output.active_low);
  return gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_OUTPUT) == 0 &&
         gpiod_line_settings_set_output_value(settings.get(), GPIOD_LINE_VALUE_INACTIVE) == 0 &&
         gpiod_line_config_add_line_settings(&lines, &output.offset, 1, settings.get()) == 0;
}

/// Null: errno.
Request request(gpiod_chip& chip, gpiod_line_config& lines) noexcept {
  const Wishes wishes{gpiod_request_config_new()};
  if (!wishes) return nullptr;
  gpiod_request_config_set_consumer(wishes.get(), kConsumer);
  gpiod_request_config_set_event_buffer_size(wishes.get(), kKernelQueue);
  return Request{gpiod_chip_request_lines(&chip, wishes.get(), &lines)};
}

class EdgesV2 final : public PolledEdges {
 public:
  EdgesV2(const EdgeConfig& config, Request request)
      : PolledEdges{config, true},
        lines_{config.lines},
        request_{std::move(request)},
        buffer_{gpiod_edge_event_buffer_new(kReadAtOnce)} {}

  /// False: errno.
  [[nodiscard]] bool start() { return buffer_ && watch(gpiod_line_request_get_fd(request_.get())); }

 private:
  Result<std::size_t> collect(std::span<hal::Edge> out) noexcept override {
    const std::size_t room = std::min(out.size(), kReadAtOnce);
    const int count = gpiod_line_request_read_edge_events(request_.get(), buffer_.get(), room);
    if (count < 0) return failed(errno);
    const auto edges = static_cast<std::size_t>(count);
    for (std::size_t i = 0; i < edges; ++i) {
      out[i] = enter(kernel_edge(gpiod_edge_event_buffer_get_event(buffer_.get(), i)));
    }
    return edges;
  }

  [[nodiscard]] KernelEdge kernel_edge(gpiod_edge_event* event) const noexcept {
    const unsigned offset = gpiod_edge_event_get_line_offset(event);
    const auto line = std::find_if(lines_.begin(), lines_.end() - 1,
                                   [offset](const EdgeLine& l) { return l.offset == offset; });
    return {.line = static_cast<std::uint8_t>(line - lines_.begin()),
            .rising = gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE,
            .monotonic_ns = static_cast<std::int64_t>(gpiod_edge_event_get_timestamp_ns(event)),
            .number = static_cast<std::uint32_t>(gpiod_edge_event_get_line_seqno(event))};
  }

  std::vector<EdgeLine> lines_;
  Request request_;
  Buffer buffer_;
};

class OutputV2 final : public hal::DigitalOutput {
 public:
  OutputV2(Request request, unsigned offset) : request_{std::move(request)}, offset_{offset} {}

 private:
  Result<bool> do_set(bool active) noexcept override {
    const gpiod_line_value value = active ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
    if (gpiod_line_request_set_value(request_.get(), offset_, value) < 0) return gpio_error(errno);
    return active;
  }

  Request request_;
  unsigned offset_;
};

}  // namespace

Outcome<std::unique_ptr<hal::EdgeSource>> open_edges(const EdgeConfig& config) {
  if (std::optional<Failure> failure = check_lines(config)) return *failure;
  const Chip chip{gpiod_chip_open(chip_path(config.chip).c_str())};
  if (!chip) return chip_failure(config.chip, errno);
  const Lines lines{gpiod_line_config_new()};
  for (const EdgeLine& line : config.lines) {
    if (!lines || !add_input(*lines, line)) return line_failure(config.chip, line.offset, errno);
  }
  Request requested = request(*chip, *lines);
  if (!requested) return line_failure(config.chip, config.lines.front().offset, errno);
  auto edges = std::make_unique<EdgesV2>(config, std::move(requested));
  if (!edges->start()) return line_failure(config.chip, config.lines.front().offset, errno);
  return std::unique_ptr<hal::EdgeSource>{std::move(edges)};
}

Outcome<std::unique_ptr<hal::DigitalOutput>> open_output(const OutputConfig& config) {
  const Chip chip{gpiod_chip_open(chip_path(config.chip).c_str())};
  if (!chip) return chip_failure(config.chip, errno);
  const Lines lines{gpiod_line_config_new()};
  if (!lines || !add_output(*lines, config)) {
    return line_failure(config.chip, config.offset, errno);
  }
  Request requested = request(*chip, *lines);
  if (!requested) return line_failure(config.chip, config.offset, errno);
  return std::unique_ptr<hal::DigitalOutput>{
      std::make_unique<OutputV2>(std::move(requested), config.offset)};
}

std::string gpio_library() { return fmt::format("libgpiod {}", gpiod_api_version()); }

}  // namespace dampline::drivers
