// SPDX-License-Identifier: MIT
#include "app/live/process.hpp"

#include <fmt/format.h>
#include <link.h>
#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <ctime>

namespace dampline::app {

namespace {

#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
#define DAMPLINE_SANITIZED
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer) || __has_feature(address_sanitizer)
#define DAMPLINE_SANITIZED
#endif
#endif
#ifdef DAMPLINE_SANITIZED
constexpr std::size_t kStackBytes = std::size_t{2} << 20U;  // what sanitizers need beside it
#else
constexpr std::size_t kStackBytes = std::size_t{512} << 10U;
#endif

/// A locked stack is there whole: with the usual 8 MiB, those of three threads would be a third of
/// what the program holds. They use 160 KB at most.
void keep_stacks_small() noexcept {
  pthread_attr_t attributes;
  if (::pthread_attr_init(&attributes) != 0) return;
  if (::pthread_attr_setstacksize(&attributes, kStackBytes) == 0)
    ::pthread_setattr_default_np(&attributes);
  ::pthread_attr_destroy(&attributes);
}

/// What the acquisition calls; the other libraries serve readers, files and fleets.
bool is_on_the_way(std::string_view library) noexcept {
  constexpr std::array<std::string_view, 7> kNames{"/libc.so",     "/libm.so",   "/libstdc++.so",
                                                   "/libgcc_s.so", "/libfmt.so", "/libgpiod.so",
                                                   "/ld-linux"};
  return library.find('/') == std::string_view::npos ||  // the program, the kernel's part
         std::any_of(kNames.begin(), kNames.end(), [library](std::string_view name) {
           return library.find(name) != std::string_view::npos;
         });
}

/// Gives up what a file can bring back: code and constants of libraries that no sample passes.
int let_go(dl_phdr_info* object, std::size_t /*size*/, void* /*nothing*/) noexcept {
  if (is_on_the_way(object->dlpi_name)) return 0;
  const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  for (int i = 0; i < object->dlpi_phnum; ++i) {
    const ElfW(Phdr)& part = object->dlpi_phdr[i];  // NOLINT(*-pointer-arithmetic): the loader's
    if (part.p_type != PT_LOAD || (part.p_flags & PF_W) != 0) continue;
    const std::uintptr_t begin = (object->dlpi_addr + part.p_vaddr) / page * page;
    const std::size_t bytes = object->dlpi_addr + part.p_vaddr + part.p_memsz - begin;
    void* const address =
        reinterpret_cast<void*>(begin);  // NOLINT(*-reinterpret-cast,*-int-to-ptr)
    if (::munlock(address, bytes) == 0) ::madvise(address, bytes, MADV_DONTNEED);
  }
  return 0;
}

}  // namespace

void lock_memory(Realtime& realtime) {
  keep_stacks_small();
  constexpr int kReturnedAbove = 1 << 20;  // else what a diagnosis held stays with the program
  ::mallopt(M_MMAP_THRESHOLD, kReturnedAbove);
  realtime.memory_locked = ::mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  if (realtime.memory_locked)
    ::dl_iterate_phdr(let_go, nullptr);
  else
    realtime.problems.push_back(
        fmt::format("Memory could not be locked ({}): the acquisition may wait for a page. Allow "
                    "it with LimitMEMLOCK=infinity or `ulimit -l unlimited`.",
                    std::strerror(errno)));
}

void schedule_fifo(int priority, Realtime& realtime) {
  if (priority == 0) return;
  sched_param parameter{};
  parameter.sched_priority = priority;
  const int error = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameter);
  realtime.scheduled = error == 0;
  if (error != 0)
    realtime.problems.push_back(fmt::format(
        "Real-time scheduling (SCHED_FIFO {}) was refused ({}): samples may be handled late, which "
        "changes no result. Allow it with LimitRTPRIO={} or `ulimit -r {}`.",
        priority, std::strerror(error), priority, priority));
}

void prefault_stack() noexcept {
  constexpr std::size_t kBytes = std::size_t{128} * 1024;
  constexpr std::size_t kPage = 4096;
  std::array<unsigned char, kBytes> stack;  // NOLINT(*-member-init): only its pages matter
  volatile unsigned char* bytes = stack.data();
  for (std::size_t i = 0; i < kBytes; i += kPage) bytes[i] = 0;
}

PageFaults page_faults_of_thread() noexcept {
  rusage usage{};
  if (::getrusage(RUSAGE_THREAD, &usage) != 0) return {};
  return {static_cast<std::uint64_t>(usage.ru_minflt), static_cast<std::uint64_t>(usage.ru_majflt)};
}

Signals::Signals() noexcept {
  ::sigemptyset(&wanted_);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) ::sigaddset(&wanted_, number);
  ::pthread_sigmask(SIG_BLOCK, &wanted_, &before_);
}

Signals::~Signals() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

SignalSeen Signals::wait(std::chrono::nanoseconds timeout) const noexcept {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const timespec limit{timeout.count() / kSecond, timeout.count() % kSecond};
  switch (::sigtimedwait(&wanted_, nullptr, &limit)) {
    case SIGINT:
    case SIGTERM:
      return SignalSeen::kStop;
    case SIGHUP:
      return SignalSeen::kRotate;
    default:
      return SignalSeen::kNone;
  }
}

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

namespace {

std::string take_variable(const char* name) {
  const char* const value = std::getenv(name);
  std::string text = value == nullptr ? "" : value;
  ::unsetenv(name);
  return text;
}

std::optional<std::int64_t> number(const std::string& text) {
  std::int64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end || value <= 0) return std::nullopt;
  return value;
}

}  // namespace

NotifyEnvironment NotifyEnvironment::take() {
  NotifyEnvironment environment{.socket = take_variable("NOTIFY_SOCKET"), .watchdog_ns = {}};
  const std::optional<std::int64_t> interval_us = number(take_variable("WATCHDOG_USEC"));
  const std::string process = take_variable("WATCHDOG_PID");
  const bool ours = process.empty() || number(process) == ::getpid();
  constexpr std::int64_t kMostUs = 1'000'000'000'000;  // beyond that nobody watches
  if (interval_us && ours && *interval_us <= kMostUs) environment.watchdog_ns = *interval_us * 1000;
  return environment;
}

Notifier::Notifier(const std::string& socket) {
  // A path, or with @ a name without a file.
  if (socket.size() < 2 || (socket[0] != '/' && socket[0] != '@')) return;
  if (socket.size() >= sizeof address_.sun_path) return;
  address_.sun_family = AF_UNIX;
  std::copy(socket.begin(), socket.end(), std::begin(address_.sun_path));
  if (socket[0] == '@') address_.sun_path[0] = '\0';
  address_bytes_ = static_cast<unsigned>(offsetof(sockaddr_un, sun_path) + socket.size());
  file_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  // A manager whose queue is full is waited for, but not for long.
  const timeval patience{.tv_sec = 0, .tv_usec = 500'000};
  static_cast<void>(::setsockopt(file_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience));
}

Notifier::~Notifier() {
  if (file_ >= 0) ::close(file_);
}

void Notifier::send(std::string_view message) noexcept {
  if (file_ < 0) return;
  const auto* const to = reinterpret_cast<const sockaddr*>(&address_);
  const ssize_t sent =
      ::sendto(file_, message.data(), message.size(), MSG_NOSIGNAL, to, address_bytes_);
  if (sent != static_cast<ssize_t>(message.size())) ++failures_;
}

void Notifier::ready(std::string_view status_text) noexcept {
  send("READY=1");
  status(status_text);
}

void Notifier::status(std::string_view text) noexcept {
  constexpr std::string_view kKey = "STATUS=";
  std::array<char, 512> message{};
  std::copy(kKey.begin(), kKey.end(), message.begin());
  const std::size_t room = message.size() - kKey.size();
  const std::string_view line = text.substr(0, std::min(text.find('\n'), room));
  std::copy(line.begin(), line.end(), message.begin() + kKey.size());
  send({message.data(), kKey.size() + line.size()});
}

void Notifier::reloading() noexcept { send("RELOADING=1"); }
void Notifier::stopping() noexcept { send("STOPPING=1"); }
void Notifier::watchdog() noexcept { send("WATCHDOG=1"); }

Watchdog::Watchdog(Notifier& notifier, std::optional<std::int64_t> timeout_ns) noexcept
    : notifier_{notifier} {
  if (timeout_ns) interval_ns_ = *timeout_ns / 4;
}

void Watchdog::look(std::uint64_t turns, std::int64_t monotonic_ns) noexcept {
  if (!interval_ns_ || turns == turns_ || monotonic_ns < next_ns_) return;
  turns_ = turns;
  next_ns_ = monotonic_ns + *interval_ns_;
  notifier_.watchdog();
  ++feeds_;
}

}  // namespace dampline::app
