// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cstddef>
#include <ctime>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace dampline::bench {

/// Processor time of this thread; what other programs take from the core does not count.
inline double thread_time_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
}

struct Contestant {
  std::string name;
  std::function<void()> run;  ///< the whole work once, from a fresh start
  double best_ns{std::numeric_limits<double>::infinity()};
};

/// Every contestant once a round, so that a slow moment of the machine meets all of them; of each
/// the best round counts.
inline void race(std::vector<Contestant>& contestants, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    for (Contestant& c : contestants) {
      const double start_ns = thread_time_ns();
      c.run();
      c.best_ns = std::min(c.best_ns, thread_time_ns() - start_ns);
    }
  }
}

}  // namespace dampline::bench
