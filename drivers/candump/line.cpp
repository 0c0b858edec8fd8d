// SPDX-License-Identifier: MIT
#include "drivers/candump/line.hpp"

#include <array>
#include <cstddef>

namespace dampline::drivers {
namespace {

constexpr std::uint8_t kNoDigit = 0xFF;
constexpr std::uint32_t kErrorFlag = 0x20000000U;
constexpr std::uint32_t kStandardMask = 0x7FFU;
constexpr std::uint32_t kExtendedMask = 0x1FFFFFFFU;
constexpr std::int64_t kLatestSecond = 9'223'372'035;  // the last whose nanoseconds fit in 63 bits
constexpr std::ptrdiff_t kLongestName = 15;

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
constexpr std::array<std::uint8_t, 256> kHex = hex_table();

inline std::uint8_t hex(char c) noexcept { return kHex[static_cast<unsigned char>(c)]; }
inline bool is_decimal(char c) noexcept { return static_cast<unsigned char>(c - '0') < 10; }

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
    frame.time_ns = seconds * 1'000'000'000 + fraction * (decimals == 6 ? 1000 : 1);
    return true;
  }

  bool interface(std::string_view& name) noexcept {
    if (*at != ' ') return fail("a space and the interface");
    while (*at == ' ') ++at;  // candump aligns names of unequal length
    const char* begin = at;
    while (*at > ' ' && *at < 0x7F && *at != '#') ++at;
    const std::ptrdiff_t length = at - begin;
    if (length < 1 || length > kLongestName || *at != ' ')
      return fail("an interface of 1 to 15 characters and a space");
    ++at;
    name = {begin, static_cast<std::size_t>(length)};
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

CandumpFault CandumpLine::parse(std::string_view line, CanFrame& frame) noexcept {
  Scanner scanner{line.data(), nullptr};
  const bool good = scanner.time(frame) && scanner.interface(interface_) &&
                    scanner.identifier(frame) && scanner.payload(frame) &&
                    scanner.end(line.data() + line.size());
  return good ? CandumpFault{} : CandumpFault{scanner.expected, scanner.at};
}

}  // namespace dampline::drivers
