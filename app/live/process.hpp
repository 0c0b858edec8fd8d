// SPDX-License-Identifier: MIT
#pragma once
#include <sys/un.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dampline::app {

/// What the kernel granted.
struct Realtime {
  bool memory_locked{false};
  bool scheduled{false};              ///< SCHED_FIFO
  std::vector<std::string> problems;  ///< one sentence for what was not granted, with the cure
  [[nodiscard]] bool whole() const noexcept { return memory_locked && scheduled; }
};

/// Keeps the memory of the whole process, present and future, from being paged out, but for the
/// code of libraries that the acquisition does not call. Call after everything large was allocated.
void lock_memory(Realtime& realtime);

/// Puts the calling thread under SCHED_FIFO. `priority` 1...99; 0: it is not asked for.
void schedule_fifo(int priority, Realtime& realtime);

/// Touches the stack that the calling thread is going to use.
void prefault_stack() noexcept;

/// Page faults of the calling thread since it began.
struct PageFaults {
  std::uint64_t minor{0};
  std::uint64_t major{0};
};
[[nodiscard]] PageFaults page_faults_of_thread() noexcept;

enum class SignalSeen : std::uint8_t { kNone, kStop, kRotate };

/// Takes SIGINT, SIGTERM and SIGHUP out of the blue into wait(). Make it before any thread, so that
/// all threads inherit it. When it goes, a further signal ends the program as usual.
class Signals {
 public:
  Signals() noexcept;
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;
  ~Signals();
  /// Sleeps until a signal arrives or the time is over.
  [[nodiscard]] SignalSeen wait(std::chrono::nanoseconds timeout) const noexcept;

 private:
  sigset_t wanted_{};
  sigset_t before_{};
};

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

/// What the service manager gave in the environment.
struct NotifyEnvironment {
  std::string socket;                       ///< NOTIFY_SOCKET
  std::optional<std::int64_t> watchdog_ns;  ///< WATCHDOG_USEC, if WATCHDOG_PID means this process
  /// Takes the variables out, so that no child believes that they are its own.
  [[nodiscard]] static NotifyEnvironment take();
};

/// Tells the service manager how the program is: one datagram for each state, as sd_notify(3)
/// describes. Spoken here and not through libsystemd, whose seven further libraries would be locked
/// into memory with the program; the protocol is stable and a few lines long. Without a manager it
/// does nothing.
class Notifier {
 public:
  explicit Notifier(const std::string& socket);
  Notifier(const Notifier&) = delete;
  Notifier& operator=(const Notifier&) = delete;
  ~Notifier();
  void ready(std::string_view status) noexcept;
  void status(std::string_view text) noexcept;
  /// To be followed by ready().
  void reloading() noexcept;
  void stopping() noexcept;
  void watchdog() noexcept;
  [[nodiscard]] bool active() const noexcept { return file_ >= 0; }
  /// Messages that could not be sent.
  [[nodiscard]] std::uint64_t failures() const noexcept { return failures_; }

 private:
  void send(std::string_view message) noexcept;

  int file_{-1};
  sockaddr_un address_{};
  unsigned address_bytes_{0};
  std::uint64_t failures_{0};
};

/// Feeds the service manager's watchdog while the acquisition's loop comes round. The loop counts a
/// turn after everything that it had read is processed, and also after a wait without frames: so a
/// lost signal is waited out, while a loop that hangs in a call, or a dead thread, starves the
/// watchdog, and the manager starts the program anew.
class Watchdog {
 public:
  /// Absent: nobody watches.
  Watchdog(Notifier& notifier, std::optional<std::int64_t> timeout_ns) noexcept;
  /// Call some times a second with the count of turns. Feeds four times in a timeout at most.
  void look(std::uint64_t turns, std::int64_t monotonic_ns) noexcept;
  [[nodiscard]] std::uint64_t feeds() const noexcept { return feeds_; }

 private:
  Notifier& notifier_;
  std::optional<std::int64_t> interval_ns_;
  std::uint64_t turns_{0};
  std::int64_t next_ns_{0};
  std::uint64_t feeds_{0};
};

}  // namespace dampline::app
