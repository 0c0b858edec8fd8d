// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <ostream>
#include <string>

#include "app/run/state.hpp"

namespace dampline::app {

/// Bytes of a state.dls, shown by their number and a hash where a test fails.
struct StateBytes {
  std::string bytes;
  [[nodiscard]] std::size_t size() const { return bytes.size(); }
  bool operator==(const StateBytes&) const = default;
  friend std::ostream& operator<<(std::ostream& out, const StateBytes& state) {
    return out << state.size() << " bytes, hash " << std::hash<std::string>{}(state.bytes);
  }
};

/// The sums of a state alone: the same record in another format, or without a date, is another
/// segment.
inline StateBytes sums_of(const std::string& state) {
  const auto sums = std::make_unique<Statistics>();
  decode_state(state, "a state", *sums);
  return {encode_state(*sums)};
}

}  // namespace dampline::app
