// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <cstdlib>
#include <type_traits>

namespace dampline {

/// What a caller can act on. Drivers add the detail (file, line, field) in their own health
/// reports.
enum class Errc : std::uint8_t {
  kInvalidConfig,  ///< a setting is out of its range
  kNotReady,       ///< not enough data yet; ask again later
  kEndOfStream,    ///< there will be no more
  kMalformed,      ///< the input does not have the form it should have
  kMismatch,       ///< two things that must agree (basis, rate) do not
  kTimeout,
  kLinkDown,
  kStorageFull,
  kIo,
};

/// A value or the reason there is none. For trivially copyable T, so that it needs no heap.
template <class T>
class [[nodiscard]] Result {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  constexpr Result(const T& value) noexcept
      : value_{value}, ok_{true} {}                         // NOLINT implicit by design
  constexpr Result(Errc error) noexcept : error_{error} {}  // NOLINT implicit by design
  [[nodiscard]] constexpr bool ok() const noexcept { return ok_; }
  constexpr explicit operator bool() const noexcept { return ok_; }
  /// Aborts when there is no value: asking without looking is our own bug.
  [[nodiscard]] constexpr const T& value() const noexcept {
    if (!ok_) std::abort();
    return value_;
  }
  [[nodiscard]] constexpr Errc error() const noexcept { return error_; }

 private:
  T value_{};
  Errc error_{Errc::kNotReady};
  bool ok_{false};
};

}  // namespace dampline
