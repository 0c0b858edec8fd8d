// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace dampline::app {

/// What the kernel granted.
struct Realtime {
  bool memory_locked{false};
  bool scheduled{false};              ///< SCHED_FIFO
  std::vector<std::string> problems;  ///< one sentence for what was not granted, with the cure
  [[nodiscard]] bool whole() const noexcept { return memory_locked && scheduled; }
};

/// Keeps the memory of the whole process, present and future, from being paged out. Call after
/// everything large was allocated.
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

}  // namespace dampline::app
