// SPDX-License-Identifier: MIT
#include "drivers/socketcan/socketcan_source.hpp"

#include <fmt/core.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "drivers/socketcan/error_frame.hpp"
#include "drivers/socketcan/open_failure.hpp"
#include "drivers/socketcan/wire_frame.hpp"

namespace dampline::drivers {
Outcome<std::unique_ptr<SocketCanSource>> SocketCanSource::open(const SocketCanConfig& config,
                                                                const hal::Clock& clock) {
  std::unique_ptr<SocketCanSource> source{new SocketCanSource{config, clock}};
  SocketAttempt opened = source->attempt();
  if (opened.failed != nullptr) return open_failure(config.interface, opened);
  source->use(std::move(opened));
  source->tell_step(source->frame_time_.begin_batch(clock, true));
  return source;
}

SocketCanSource::SocketCanSource(const SocketCanConfig& config, const hal::Clock& clock)
    : config_{config},
      filters_{make_filters(config.identifiers)},
      clock_{clock},
      frame_time_{config.run_time, config.hardware_times} {}

std::string SocketCanSource::error_text() const {
  if (refused_ == nullptr) return {};
  return fmt::format("{}: {}: {}", config_.interface, refused_, std::strerror(refused_errno_));
}

std::int64_t SocketCanSource::now() const noexcept {
  return config_.run_time.from_monotonic(clock_.monotonic_ns());
}

SocketAttempt SocketCanSource::attempt() const noexcept {
  return open_for_receiving(config_.interface.c_str(),
                            {.filters = filters_,
                             .receive_buffer_bytes = config_.receive_buffer_bytes,
                             .hardware_times = config_.hardware_times});
}

void SocketCanSource::use(SocketAttempt opened) noexcept {
  socket_ = std::move(opened.socket);
  interface_index_ = opened.interface_index;
  receive_buffer_bytes_ = opened.receive_buffer_bytes;
  drops_seen_ = 0;
}

void SocketCanSource::tell(hal::EventKind kind, std::int64_t value) noexcept {
  const std::int64_t time_ns = std::max(now(), frame_time_.newest_ns());
  events_.push({.time_ns = time_ns, .kind = kind, .value = value});
}

hal::SourceHealth SocketCanSource::do_health() const noexcept {
  hal::SourceHealth health = health_;
  health.reordered = frame_time_.reordered();
  return health;
}

Result<std::size_t> SocketCanSource::do_read(std::span<CanFrame> out) noexcept {
  if (out.empty()) return std::size_t{0};
  if (!health_.link_up) watch_outage();
  std::size_t count = 0;
  for (bool more = socket_.is_open(); more && count < out.size();) {
    count += read_batch(out.subspan(count), more);
  }
  health_.frames += count;
  if (count > 0 || health_.link_up) return count;
  return Errc::kLinkDown;
}

std::size_t SocketCanSource::read_batch(std::span<CanFrame> out, bool& more) noexcept {
  const std::size_t asked = std::min(out.size(), MessageBatch::kMessages);
  const std::span<mmsghdr> headers = batch_.prepare(asked);
  const int got = ::recvmmsg(socket_.file(), headers.data(), static_cast<unsigned>(asked),
                             MSG_DONTWAIT, nullptr);
  if (got < 0) {
    more = take_failure(errno);
    return 0;
  }
  const auto messages = static_cast<std::size_t>(got);
  more = messages == asked || pending_ != Outage::kNone;
  const std::int64_t step_ns = frame_time_.begin_batch(clock_, messages < asked);
  const std::size_t count = take_batch(messages, out);
  tell_step(step_ns);
  return count;
}

std::size_t SocketCanSource::take_batch(std::size_t messages, std::span<CanFrame> out) noexcept {
  std::size_t count = 0;
  for (std::size_t i = 0; i < messages; ++i) {
    CanFrame& frame = out[count];
    if (!from_wire(batch_.frame(i), batch_.bytes(i), frame)) {
      ++health_.malformed;
      continue;
    }
    const MessageInfo info = batch_.info(i);
    frame_time_.stamp(info.stamp, frame);
    if (frame.time_source == TimeSource::kHardware) ++health_.hardware_times;
    if (info.drops) take_drops(*info.drops, frame.time_ns);
    if (frame.error) take_error_frame(frame);
    ++count;
  }
  return count;
}

// The total is 32 bits wide and wraps. A frame that was queued before take_silent_drops() looked
// may tell an older one.
void SocketCanSource::take_drops(std::uint32_t total, std::int64_t time_ns) noexcept {
  const auto more = static_cast<std::int32_t>(total - drops_seen_);
  if (more <= 0) return;
  drops_seen_ = total;
  health_.dropped += static_cast<std::uint32_t>(more);
  events_.push({.time_ns = time_ns, .kind = hal::EventKind::kFramesDropped, .value = more});
}

void SocketCanSource::take_error_frame(const CanFrame& frame) noexcept {
  ++health_.error_frames;
  const ErrorEvents told = error_events(frame);
  for (std::size_t i = 0; i < told.count; ++i) {
    const hal::Event& event = told.events[i];
    if (event.kind == hal::EventKind::kBusOff) ++health_.bus_offs;
    if (event.kind == hal::EventKind::kBusRestarted) ++health_.restarts;
    events_.push(event);
  }
}

void SocketCanSource::tell_step(std::int64_t step_ns) noexcept {
  if (step_ns == 0) return;
  ++health_.clock_steps;
  events_.push(
      {.time_ns = frame_time_.newest_ns(), .kind = hal::EventKind::kClockStep, .value = step_ns});
}

}  // namespace dampline::drivers
