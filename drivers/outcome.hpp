// SPDX-License-Identifier: MIT
#pragma once
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>

#include "dampline/result.hpp"

namespace dampline::drivers {

/// Why something could not be done, as a person reads it: file and line, what was found, what was
/// expected.
struct Failure {
  Errc code{Errc::kMalformed};
  std::string text;
};

/// A value or a Failure. The drivers' Result: may own memory and carries its explanation.
template <class T>
class [[nodiscard]] Outcome {
 public:
  Outcome(T value) : value_{std::move(value)} {}              // NOLINT implicit by design
  Outcome(Failure failure) : failure_{std::move(failure)} {}  // NOLINT implicit by design
  [[nodiscard]] bool ok() const noexcept { return value_.has_value(); }
  [[nodiscard]] explicit operator bool() const noexcept { return ok(); }
  /// Aborts when there is no value: asking without looking is our own bug.
  [[nodiscard]] T& value() {
    if (!value_) std::abort();
    return *value_;
  }
  [[nodiscard]] const T& value() const {
    if (!value_) std::abort();
    return *value_;
  }
  [[nodiscard]] const Failure& failure() const noexcept { return failure_; }
  [[nodiscard]] const std::string& error_text() const noexcept { return failure_.text; }

 private:
  std::optional<T> value_;
  Failure failure_;
};

}  // namespace dampline::drivers
