// SPDX-License-Identifier: MIT
#include "drivers/socketcan/source.hpp"

#include <fmt/core.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <utility>

#include "drivers/socketcan/message.hpp"
#include "drivers/socketcan/socket.hpp"

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

namespace {

constexpr std::int64_t kPollFailedNs = 10'000'000;

}  // namespace

Result<bool> SocketCanSource::do_wait(std::chrono::nanoseconds timeout) noexcept {
  const std::int64_t deadline_ns = clock_.monotonic_ns() + timeout.count();
  std::int64_t left_ns = timeout.count();
  const bool away = !health_.link_up;
  do {
    if (away) watch_outage();
    if (away && health_.link_up) return true;
    const Poll polled = poll_for(away ? std::min(left_ns, kLookEveryNs) : left_ns);
    if (polled == Poll::kReady) return true;
    if (polled == Poll::kInterrupted) return false;
    if (polled == Poll::kFailed) {  // so read() has to be tried instead, but not without a pause
      clock_.sleep_until(std::min(deadline_ns, clock_.monotonic_ns() + kPollFailedNs));
      return true;
    }
    left_ns = deadline_ns - clock_.monotonic_ns();
  } while (left_ns > 0);
  return take_silent_drops();
}

SocketCanSource::Poll SocketCanSource::poll_for(std::int64_t time_ns) noexcept {
  time_ns = std::max<std::int64_t>(time_ns, 0);
  timespec left{};
  left.tv_sec = static_cast<time_t>(time_ns / hal::kSecondNs);
  left.tv_nsec = static_cast<long>(time_ns % hal::kSecondNs);  // NOLINT the type of tv_nsec
  pollfd entry{.fd = socket_.file(), .events = POLLIN, .revents = 0};
  const int ready = ::ppoll(&entry, socket_.is_open() ? 1 : 0, &left, nullptr);
  if (ready > 0) return Poll::kReady;
  if (ready == 0) return Poll::kTimeout;
  if (errno == EINTR) return Poll::kInterrupted;
  refused_ = "ppoll";
  refused_errno_ = errno;
  return Poll::kFailed;
}

bool SocketCanSource::take_silent_drops() noexcept {
  if (!socket_.is_open()) return false;
  const std::uint64_t before = health_.dropped;
  take_drops(socket_.drops(drops_seen_), now());
  return health_.dropped != before;
}

bool SocketCanSource::take_failure(int error_number) noexcept {
  switch (error_number) {
    case EAGAIN:
      tell_step(frame_time_.begin_batch(clock_, true));
      if (pending_ != Outage::kNone) begin_outage();
      return false;
    case ENETDOWN:
      return postpone(Outage::kDown);
    case ENODEV:
    case ENXIO:
      return postpone(Outage::kRemoved);
    default:
      break;
  }
  if (error_number == EINTR) return false;
  refused_ = "recvmmsg";
  refused_errno_ = error_number;
  if (error_number == ENOMEM || error_number == ENOBUFS) return false;  // will pass
  pending_ = Outage::kFailed;
  begin_outage();
  return false;
}

// The kernel tells an error before the frames that are still queued, and each error once.
bool SocketCanSource::postpone(Outage outage) noexcept {
  const bool again = pending_ >= outage;
  pending_ = std::max(pending_, outage);
  if (again) begin_outage();
  return !again;
}

void SocketCanSource::begin_outage() noexcept {
  const Outage outage = std::exchange(pending_, Outage::kNone);
  if (health_.link_up) {
    health_.link_up = false;
    ++health_.link_downs;
    tell(hal::EventKind::kLinkDown);
  }
  if (outage != Outage::kDown) close_socket(outage == Outage::kRemoved);
}

// The kernel does not tell a socket that its interface is up again, so it is asked.
void SocketCanSource::watch_outage() noexcept {
  const char* const interface = config_.interface.c_str();
  if (!socket_.is_open()) reopen();
  if (!socket_.is_open()) return;
  if (socket_.interface_index(interface) != interface_index_) {
    close_socket(true);
  } else if (socket_.interface_up(interface)) {
    health_.link_up = true;
    tell(hal::EventKind::kLinkUp);
  }
}

void SocketCanSource::close_socket(bool removed) noexcept {
  take_silent_drops();
  socket_.close();
  next_look_ns_ = 0;
  if (!removed || removed_) return;
  removed_ = true;
  tell(hal::EventKind::kInterfaceRemoved);
}

void SocketCanSource::reopen() noexcept {
  const std::int64_t monotonic_ns = clock_.monotonic_ns();
  if (monotonic_ns < next_look_ns_) return;
  next_look_ns_ = monotonic_ns + kLookEveryNs;
  SocketAttempt opened = attempt();
  if (opened.failed != nullptr) {
    refused_ = opened.failed;
    refused_errno_ = opened.error_number;
    return;
  }
  use(std::move(opened));
  ++health_.reopened;
  if (!std::exchange(removed_, false)) return;
  tell(hal::EventKind::kInterfaceBack);
}

}  // namespace dampline::drivers
