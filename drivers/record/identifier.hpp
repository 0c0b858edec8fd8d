// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace dampline::drivers {

// What marks an identifier where it is one word of 32 bits, as Linux has it.
inline constexpr std::uint32_t kExtendedFlag = 0x80000000U;
inline constexpr std::uint32_t kRemoteFlag = 0x40000000U;
inline constexpr std::uint32_t kErrorFlag = 0x20000000U;
inline constexpr std::uint32_t kStandardMask = 0x7FFU;
inline constexpr std::uint32_t kExtendedMask = 0x1FFFFFFFU;
inline constexpr std::size_t kLongestName = 15;  ///< of an interface

/// "can1": what a format that numbers its channels calls an interface.
class ChannelName {
 public:
  /// Lasts as long as this object, until the next set().
  [[nodiscard]] std::string_view set(std::uint32_t number) noexcept {
    const auto end = std::to_chars(text_.data() + 3, text_.data() + text_.size(), number);
    return {text_.data(), static_cast<std::size_t>(end.ptr - text_.data())};
  }

 private:
  std::array<char, 16> text_{'c', 'a', 'n'};
};

}  // namespace dampline::drivers
