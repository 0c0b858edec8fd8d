// SPDX-License-Identifier: MIT
#include "app/live/realtime.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>

namespace dampline::app {

void lock_memory(Realtime& realtime) {
  realtime.memory_locked = ::mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  if (!realtime.memory_locked)
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

}  // namespace dampline::app
