// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/outcome.hpp"
#include "drivers/socketcan/frame_time.hpp"
#include "drivers/socketcan/message.hpp"
#include "drivers/socketcan/socket.hpp"
#include "hal/clock.hpp"
#include "hal/event.hpp"
#include "hal/frame_source.hpp"

namespace dampline::drivers {

/// Events in a fixed ring, in the order of their time: an earlier one takes the time of the one
/// before. When the ring is full the oldest gives way.
class EventQueue {
 public:
  void push(const hal::Event& event) noexcept {
    newest_ns_ = std::max(newest_ns_, event.time_ns);
    hal::Event& place = events_[(first_ + size_) % kCapacity];
    place = event;
    place.time_ns = newest_ns_;
    if (size_ < kCapacity) {
      ++size_;
    } else {
      first_ = (first_ + 1) % kCapacity;
    }
  }
  [[nodiscard]] bool pop(hal::Event& out) noexcept {
    if (size_ == 0) return false;
    out = events_[first_];
    first_ = (first_ + 1) % kCapacity;
    --size_;
    return true;
  }
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }

 private:
  static constexpr std::size_t kCapacity = 1024;
  std::array<hal::Event, kCapacity> events_{};
  std::size_t first_{0};
  std::size_t size_{0};
  std::int64_t newest_ns_{0};
};

struct SocketCanConfig {
  std::string interface {};                   ///< say can0; must exist, may be down
  std::vector<Identifier> identifiers{};      ///< empty, or more than kMostFilters: every frame
  int receive_buffer_bytes{8 * 1024 * 1024};  ///< asked for; about 10,000 frames
  bool hardware_times{true};                  ///< where the controller stamps frames
  hal::RunTime run_time{};
};

/// A CAN interface as a source of frames, for as long as one likes. Error frames are delivered, and
/// told as events. After open() nothing allocates.
///
/// Down and up again: read() is kLinkDown in between, the socket stays. Removed: the socket is
/// closed and opened anew when the interface is back, looked for every 200 ms in read() and wait().
/// Whatever else the kernel refuses is met in the same way, and error_text() says what it was.
/// Frames that were queued before an outage are delivered before it is reported. While it lasts,
/// wait() is true only when it has ended.
///
/// One thread uses it, the clock must outlive it.
class SocketCanSource final : public hal::FrameSource {
 public:
  static Outcome<std::unique_ptr<SocketCanSource>> open(const SocketCanConfig& config,
                                                        const hal::Clock& clock);

  /// As the kernel granted it; it counts its own overhead, and doubles what was asked for.
  [[nodiscard]] int receive_buffer_bytes() const noexcept { return receive_buffer_bytes_; }
  [[nodiscard]] const std::string& interface() const noexcept { return config_.interface; }
  /// What the kernel refused last, beside links that went down; empty: nothing yet.
  [[nodiscard]] std::string error_text() const;

 private:
  enum class Outage : std::uint8_t { kNone, kDown, kRemoved, kFailed };

  SocketCanSource(const SocketCanConfig& config, const hal::Clock& clock);
  [[nodiscard]] Result<std::size_t> do_read(std::span<CanFrame> out) noexcept override;
  [[nodiscard]] Result<bool> do_wait(std::chrono::nanoseconds timeout) noexcept override;
  [[nodiscard]] hal::SourceHealth do_health() const noexcept override;
  [[nodiscard]] bool do_next_event(hal::Event& out) noexcept override { return events_.pop(out); }
  [[nodiscard]] std::optional<std::int64_t> do_now_ns() const noexcept override { return now(); }

  [[nodiscard]] std::int64_t now() const noexcept;
  [[nodiscard]] SocketAttempt attempt() const noexcept;
  void use(SocketAttempt opened) noexcept;
  /// One call of recvmmsg. Returns frames; `more`: there may be another batch.
  std::size_t read_batch(std::span<CanFrame> out, bool& more) noexcept;
  std::size_t take_batch(std::size_t messages, std::span<CanFrame> out) noexcept;
  void take_drops(std::uint32_t total, std::int64_t time_ns) noexcept;
  void take_error_frame(const CanFrame& frame) noexcept;
  void tell_step(std::int64_t step_ns) noexcept;
  /// True: there may be frames behind the error.
  bool take_failure(int error_number) noexcept;
  bool postpone(Outage outage) noexcept;
  void begin_outage() noexcept;
  void watch_outage() noexcept;
  void close_socket(bool removed) noexcept;
  void reopen() noexcept;
  enum class Poll : std::uint8_t { kReady, kTimeout, kInterrupted, kFailed };
  [[nodiscard]] Poll poll_for(std::int64_t time_ns) noexcept;
  /// Drops that no later frame has told yet. True: there were some.
  bool take_silent_drops() noexcept;
  void tell(hal::EventKind kind, std::int64_t value = 0) noexcept;

  SocketCanConfig config_;
  std::vector<can_filter> filters_;
  const hal::Clock& clock_;
  CanSocket socket_;
  int interface_index_{0};
  int receive_buffer_bytes_{0};
  MessageBatch batch_;
  FrameTime frame_time_;
  EventQueue events_;
  hal::SourceHealth health_{};
  Outage pending_{Outage::kNone};  // reported once the queue is empty
  std::uint32_t drops_seen_{0};    // of this socket
  std::int64_t next_look_ns_{0};   // monotonic; when to try again to open a socket
  bool removed_{false};            // the interface; told, and not yet told that it is back
  const char* refused_{nullptr};
  int refused_errno_{0};
};

}  // namespace dampline::drivers
