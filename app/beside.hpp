// SPDX-License-Identifier: MIT
#pragma once
#include <future>
#include <system_error>
#include <utility>

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

}  // namespace dampline::app
