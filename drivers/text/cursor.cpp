// SPDX-License-Identifier: MIT
#include "drivers/text/cursor.hpp"

#include <array>
#include <charconv>
#include <cstddef>
#include <system_error>

namespace dampline::drivers {
namespace {

constexpr std::int64_t kMostWhole = 9'223'372'035;  // the last whose 10^9 fold fits in 63 bits
constexpr int kDecimals = 9;

}  // namespace

std::string_view without_byte_order_mark(std::string_view text) noexcept {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
  return text;
}

std::string_view take_word(std::string_view& rest) noexcept {
  std::size_t begin = 0;
  while (begin < rest.size() && is_blank(rest[begin])) ++begin;
  std::size_t end = begin;
  while (end < rest.size() && !is_blank(rest[end])) ++end;
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

std::optional<std::uint32_t> read_whole_number(std::string_view word, int base) noexcept {
  std::uint32_t out = 0;
  const char* end = word.data() + word.size();
  const auto result = std::from_chars(word.data(), end, out, base);
  if (result.ec != std::errc{} || result.ptr != end) return std::nullopt;
  return out;
}

std::optional<std::int64_t> read_nano(std::string_view word) noexcept {
  std::int64_t whole = 0;
  std::size_t i = 0;
  const auto is_digit = [&] { return i < word.size() && word[i] >= '0' && word[i] <= '9'; };
  for (; is_digit(); ++i) {
    whole = whole * 10 + (word[i] - '0');
    if (whole > kMostWhole) return std::nullopt;
  }
  if (i == 0) return std::nullopt;
  std::int64_t fraction = 0;
  int decimals = 0;
  if (i < word.size() && word[i] == '.') {
    for (++i; is_digit(); ++i) {
      if (decimals == kDecimals) continue;
      fraction = fraction * 10 + (word[i] - '0');
      ++decimals;
    }
  }
  if (i != word.size()) return std::nullopt;
  for (; decimals < kDecimals; ++decimals) fraction *= 10;
  return whole * 1'000'000'000 + fraction;
}

const char* take_bytes(std::string_view& rest, std::size_t count, int base,
                       CanFrame& frame) noexcept {
  frame.data.fill(0);
  frame.length = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string_view word = take_word(rest);
    const auto byte = read_whole_number(word, base);
    if (!byte || *byte > 0xFF || i >= frame.data.size()) return word.data();
    frame.data[i] = static_cast<std::uint8_t>(*byte);
    frame.length = static_cast<std::uint8_t>(i + 1);
  }
  return nullptr;
}

std::uint8_t length_of_code(std::uint32_t code) noexcept {
  constexpr std::array<std::uint8_t, 16> kLengths{0, 1,  2,  3,  4,  5,  6,  7,
                                                  8, 12, 16, 20, 24, 32, 48, 64};
  return kLengths[code & 15U];
}

}  // namespace dampline::drivers
