// SPDX-License-Identifier: MIT
#include "drivers/candump/line_writer.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace dampline::drivers {
namespace {

constexpr std::string_view kHex = "0123456789ABCDEF";
constexpr std::uint32_t kErrorFlag = 0x20000000U;
constexpr std::size_t kLongestName = 15;
constexpr std::size_t kMostClassic = 8;
constexpr std::size_t kMostFd = 64;

/// `digits` decimal digits of `value`, leading zeros kept.
char* put_decimal(char* at, std::uint64_t value, int digits) noexcept {
  for (int i = digits - 1; i >= 0; --i) {
    at[i] = static_cast<char>('0' + value % 10);
    value /= 10;
  }
  return at + digits;
}

char* put_hex(char* at, std::uint32_t value, int digits) noexcept {
  for (int i = digits - 1; i >= 0; --i) {
    at[i] = kHex[value & 0xfU];
    value >>= 4U;
  }
  return at + digits;
}

char* put_text(char* at, std::string_view text) noexcept { return at + text.copy(at, text.size()); }

char* put_time(char* at, std::int64_t time_ns) noexcept {
  const auto micro = static_cast<std::uint64_t>(std::max<std::int64_t>(time_ns, 0)) / 1000;
  *at++ = '(';
  at = put_decimal(at, micro / 1'000'000, 10);
  *at++ = '.';
  at = put_decimal(at, micro % 1'000'000, 6);
  return put_text(at, ") ");
}

char* put_identifier(char* at, const CanFrame& frame) noexcept {
  if (frame.error) return put_hex(at, frame.id | kErrorFlag, 8);
  return put_hex(at, frame.id, frame.extended ? 8 : 3);
}

char* put_content(char* at, const CanFrame& frame) noexcept {
  *at++ = '#';
  if (frame.remote && !frame.fd) {
    *at++ = 'R';
    return frame.length > 0 && frame.length <= kMostClassic ? put_hex(at, frame.length, 1) : at;
  }
  if (frame.fd) {
    *at++ = '#';
    at = put_hex(at, frame.fd_flags, 1);
  }
  const std::size_t length = std::min<std::size_t>(frame.length, frame.fd ? kMostFd : kMostClassic);
  for (std::size_t i = 0; i < length; ++i) at = put_hex(at, frame.data[i], 2);
  return at;
}

}  // namespace

void append_candump(fmt::memory_buffer& text, const CanFrame& frame,
                    std::string_view interface_name, std::size_t name_width) {
  std::array<char, 256> line{};
  const std::string_view name = interface_name.substr(0, kLongestName);
  char* at = put_time(line.data(), frame.time_ns);
  for (std::size_t i = name.size(); i < std::min(name_width, kLongestName); ++i) *at++ = ' ';
  at = put_text(at, name);
  *at++ = ' ';
  at = put_identifier(at, frame);
  at = put_content(at, frame);
  *at++ = '\n';
  text.append(line.data(), at);
}

}  // namespace dampline::drivers
