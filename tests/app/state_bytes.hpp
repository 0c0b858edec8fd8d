// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <functional>
#include <ostream>
#include <string>

namespace dampline::app {

/// The bytes of a state.dls, shown by their number and a hash where a test fails.
struct StateBytes {
  std::string bytes;
  [[nodiscard]] std::size_t size() const { return bytes.size(); }
  bool operator==(const StateBytes&) const = default;
  friend std::ostream& operator<<(std::ostream& out, const StateBytes& state) {
    return out << state.size() << " bytes, hash " << std::hash<std::string>{}(state.bytes);
  }
};

}  // namespace dampline::app
