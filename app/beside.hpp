// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <future>
#include <system_error>
#include <thread>
#include <vector>

namespace dampline::app {

/// Calls a function beside the caller or, where the system has no thread to give, when its result
/// is asked for.
template <class Function, class... Arguments>
[[nodiscard]] auto beside(const Function& function, const Arguments&... arguments) {
  try {
    return std::async(std::launch::async, function, arguments...);
  } catch (const std::system_error&) {
    return std::async(std::launch::deferred, function, arguments...);
  }
}

/// Calls function(0) to function(count - 1), as many at a time as there are processors, each in any
/// order; what they throw comes out when all have ended.
template <class Function>
void each_beside(std::size_t count, const Function& function) {
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) function(i);
  };
  const std::size_t at_once = std::min<std::size_t>(count, std::thread::hardware_concurrency());
  std::vector<std::future<void>> others;
  for (std::size_t i = 1; i < at_once; ++i) others.push_back(beside(work));
  work();
  for (std::future<void>& other : others) other.get();
}

/// Likewise where so many values, each touched once or twice, take longer than threads to begin;
/// otherwise one call after the other.
template <class Function>
void each_of_values(std::ptrdiff_t values, std::size_t count, const Function& function) {
  constexpr std::ptrdiff_t kWorthThreads = 50'000;  // a millisecond of work
  if (values > kWorthThreads) return each_beside(count, function);
  for (std::size_t i = 0; i < count; ++i) function(i);
}

}  // namespace dampline::app
