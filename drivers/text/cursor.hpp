// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <optional>
#include <string_view>

#include "dampline/can_frame.hpp"

namespace dampline::drivers {

/// Between the words of a line.
[[nodiscard]] constexpr bool is_blank(char c) noexcept { return c == ' ' || c == '\t'; }

/// Without the byte order mark of UTF-8, which some programs write first.
[[nodiscard]] std::string_view without_byte_order_mark(std::string_view text) noexcept;

/// Takes the next word, between blanks and tabs, off the front of a line; empty: there is none.
[[nodiscard]] std::string_view take_word(std::string_view& rest) noexcept;

/// The whole word as an unsigned number of at most 32 bits; base 10 or 16.
[[nodiscard]] std::optional<std::uint32_t> read_whole_number(std::string_view word,
                                                             int base) noexcept;

/// The whole word, such as "12.345678", times 10^9 and without rounding: digits below it are
/// dropped. Nothing above 9.2e9, for what is no number, and for a negative one.
[[nodiscard]] std::optional<std::int64_t> read_nano(std::string_view word) noexcept;

/// Takes `count` bytes, a word each, as numbers of the base. Returns where it failed, or null.
[[nodiscard]] const char* take_bytes(std::string_view& rest, std::size_t count, int base,
                                     CanFrame& frame) noexcept;

/// Payload of a CAN FD length code: 0...8, 12, 16, 20, 24, 32, 48, 64. Precondition: code <= 15.
[[nodiscard]] std::uint8_t length_of_code(std::uint32_t code) noexcept;

}  // namespace dampline::drivers
