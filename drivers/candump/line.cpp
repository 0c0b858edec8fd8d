// SPDX-License-Identifier: MIT
#include "drivers/candump/line.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "drivers/record/identifier.hpp"
#include "hal/clock.hpp"

namespace dampline::drivers {
namespace {

constexpr std::uint8_t kNoDigit = 0xFF;
constexpr std::int64_t kLatestSecond = 9'223'372'035;  // the last whose nanoseconds fit in 63 bits

constexpr std::array<std::uint8_t, 256> hex_table() {
  std::array<std::uint8_t, 256> table{};
  table.fill(kNoDigit);
  for (std::uint8_t i = 0; i < 10; ++i) table[static_cast<std::size_t>('0' + i)] = i;
  for (std::uint8_t i = 10; i < 16; ++i) {
    table[static_cast<std::size_t>('A' + i - 10)] = i;
    table[static_cast<std::size_t>('a' + i - 10)] = i;
  }
  return table;
}
constexpr std::array<std::uint8_t, 256> kHexValues = hex_table();

inline std::uint8_t hex(char c) noexcept { return kHexValues[static_cast<unsigned char>(c)]; }
inline bool is_decimal(char c) noexcept { return static_cast<unsigned char>(c - '0') < 10; }

// A line as candump -l writes it: "(", ten digits, ".", six digits, ")".
constexpr std::size_t kPoint = 11;
constexpr std::size_t kClosing = 18;
constexpr std::size_t kUsual = kPoint + 9;  // characters that are read at once

std::uint64_t eight(const char* text) noexcept {
  std::uint64_t out = 0;
  std::memcpy(&out, text, sizeof out);
  return out;
}

/// Of "123456)", all digits at once (D. Lemire, "Quickly parsing eight digits", 2018); negative:
/// something else stands there.
std::int64_t six_decimals(const char* text) noexcept {
  const std::uint64_t characters = eight(text);
  const std::uint64_t digits = (characters & 0xFFFF'FFFF'FFFFU) ^ 0x3030'3030'3030U;
  const bool good = (((digits + 0x7676'7676'7676U) | digits) & 0x8080'8080'8080U) == 0 &&
                    (characters >> 48U & 0xFFU) == ')';
  if (!good) return -1;
  std::uint64_t pairs = digits << 16U;  // two zeros before them
  pairs = pairs * 10 + (pairs >> 8U);
  constexpr std::uint64_t kPairs = 0x0000'00FF'0000'00FFU;
  const std::uint64_t sum = (pairs & kPairs) * (100 + (1'000'000ULL << 32U)) +
                            (pairs >> 16U & kPairs) * (1 + (10'000ULL << 32U));
  return static_cast<std::int64_t>(sum >> 32U);
}

/// Reads on from a place in the line; every step stops at the line's end, because what stands there
/// is neither a digit nor any mark. `expected` stays null as long as all fits.
struct Scanner {
  const char* at{nullptr};
  const char* expected{nullptr};

  bool fail(const char* what) noexcept {
    expected = what;
    return false;
  }

  bool time(CanFrame& frame) noexcept {
    if (*at != '(') return fail("( and a time");
    ++at;
    std::int64_t seconds = 0;
    const char* begin = at;
    for (; is_decimal(*at) && at - begin < 11; ++at) seconds = seconds * 10 + (*at - '0');
    if (at == begin || *at != '.' || seconds > kLatestSecond)
      return fail("seconds since 1970 and a point");
    begin = ++at;
    std::int64_t fraction = 0;
    for (; is_decimal(*at) && at - begin < 10; ++at) fraction = fraction * 10 + (*at - '0');
    const std::ptrdiff_t decimals = at - begin;
    if ((decimals != 6 && decimals != 9) || *at != ')') return fail("6 or 9 decimals and )");
    ++at;
    frame.time_ns = seconds * hal::kSecondNs + fraction * (decimals == 6 ? 1000 : 1);
    return true;
  }

  bool interface(std::string_view& name) noexcept {
    if (*at != ' ') return fail("a space and the interface");
    while (*at == ' ') ++at;  // candump aligns names of unequal length
    const char* begin = at;
    while (*at > ' ' && *at < 0x7F && *at != '#') ++at;
    const auto length = static_cast<std::size_t>(at - begin);
    if (length < 1 || length > kLongestName || *at != ' ')
      return fail("an interface of 1 to 15 characters and a space");
    ++at;
    name = {begin, length};
    return true;
  }

  bool identifier(CanFrame& frame) noexcept {
    const char* begin = at;
    std::uint32_t id = 0;
    for (; hex(*at) != kNoDigit && at - begin < 9; ++at) id = id << 4U | hex(*at);
    const std::ptrdiff_t digits = at - begin;
    if (*at != '#' || (digits != 3 && digits != 8)) return fail("3 or 8 hexadecimal digits and #");
    ++at;
    frame.extended = digits == 8;
    frame.error = digits == 8 && (id & kErrorFlag) != 0;
    frame.id = frame.error ? id & ~kErrorFlag : id;
    if (frame.id > (frame.extended ? kExtendedMask : kStandardMask))
      return fail("an identifier of 11 or 29 bits");
    if (frame.error) frame.extended = false;
    return true;
  }

  bool payload(CanFrame& frame) noexcept {
    frame.fd = false;
    frame.fd_flags = 0;
    frame.remote = false;
    frame.data.fill(0);
    frame.length = 0;
    if (*at == 'R' || *at == 'r') return remote(frame);
    if (*at == '#') return fd(frame);
    if (!bytes(frame, 8)) return false;
    // `_9` to `_F`: the length code of a full frame, which says nothing to us.
    if (*at == '_' && frame.length == 8 && hex(at[1]) != kNoDigit) at += 2;
    return true;
  }

  bool remote(CanFrame& frame) noexcept {
    frame.remote = true;
    ++at;
    if (*at >= '0' && *at <= '8') frame.length = static_cast<std::uint8_t>(*at++ - '0');
    return true;
  }

  bool fd(CanFrame& frame) noexcept {
    ++at;
    if (hex(*at) == kNoDigit) return fail("one digit of CAN FD flags");
    frame.fd_flags = hex(*at++);
    frame.fd = true;
    if (!bytes(frame, 64)) return false;
    const std::uint8_t length = frame.length;
    const bool allowed = length <= 8 || (length <= 24 && length % 4 == 0) || length == 32 ||
                         length == 48 || length == 64;
    return allowed || fail("a CAN FD length: 0-8, 12, 16, 20, 24, 32, 48 or 64 bytes");
  }

  bool bytes(CanFrame& frame, std::uint8_t most) noexcept {
    std::uint8_t count = 0;
    for (; count < most; ++count) {
      const std::uint8_t high = hex(*at);
      if (high == kNoDigit) break;
      const std::uint8_t low = hex(at[1]);
      if (low == kNoDigit) return fail("two hexadecimal digits a byte");
      frame.data[count] = static_cast<std::uint8_t>(high << 4U | low);
      at += 2;
      if (*at == '.') ++at;
    }
    frame.length = count;
    return true;
  }

  bool end(const char* line_end) noexcept {
    if (at == line_end) return true;
    if (line_end - at >= 2 && *at == ' ' && (at[1] == 'R' || at[1] == 'T')) at += 2;
    while (at != line_end && *at == ' ') ++at;
    return at == line_end || fail("the end of the line");
  }
};

}  // namespace

bool CandumpLine::take_same_second(std::string_view line, CanFrame& frame) const noexcept {
  if (second_ns_ < 0 || line.size() < kUsual || eight(line.data()) != second_text_[0] ||
      eight(line.data() + 4) != second_text_[1])
    return false;
  const std::int64_t microseconds = six_decimals(line.data() + kPoint + 1);
  frame.time_ns = second_ns_ + microseconds * 1000;
  return microseconds >= 0;
}

void CandumpLine::remember_second(std::string_view line, std::int64_t time_ns) noexcept {
  if (std::endian::native != std::endian::little || line.size() < kUsual || line[kPoint] != '.')
    return;
  second_text_ = {eight(line.data()), eight(line.data() + 4)};
  second_ns_ = time_ns - time_ns % hal::kSecondNs;
}

CandumpFault CandumpLine::parse(std::string_view line, CanFrame& frame) noexcept {
  Scanner scanner{line.data(), nullptr};
  bool good = take_same_second(line, frame);
  if (good) {
    scanner.at += kClosing + 1;
  } else {
    good = scanner.time(frame);
    if (good && scanner.at == line.data() + kClosing + 1) remember_second(line, frame.time_ns);
  }
  good = good && scanner.interface(interface_) && scanner.identifier(frame) &&
         scanner.payload(frame) && scanner.end(line.data() + line.size());
  return good ? CandumpFault{} : CandumpFault{scanner.expected, scanner.at};
}

namespace {

constexpr std::string_view kHexDigits = "0123456789ABCDEF";
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
    at[i] = kHexDigits[value & 0xfU];
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
