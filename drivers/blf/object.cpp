// SPDX-License-Identifier: MIT
#include "drivers/blf/object.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <limits>
#include <string_view>

#include "drivers/bytes/little_endian.hpp"
#include "drivers/record/identifier.hpp"
#include "hal/clock.hpp"

namespace dampline::drivers {
namespace {

constexpr std::uint32_t kCanMessage = 1;
constexpr std::uint32_t kCanErrorExt = 73;
constexpr std::uint32_t kCanMessage2 = 86;
constexpr std::uint32_t kCanFdMessage = 100;
constexpr std::uint32_t kCanFdMessage64 = 101;
constexpr std::uint32_t kTenMicroseconds = 1;

using Body = std::span<const char>;

template <class T>
T at(Body body, std::size_t offset) noexcept {
  return little<T>(body.data() + offset);
}

void set_id(CanFrame& frame, std::uint32_t id) noexcept {
  frame.extended = (id & kExtendedFlag) != 0;
  frame.id = id & (frame.extended ? kExtendedMask : kStandardMask);
}

bool copy_data(CanFrame& frame, Body body, std::size_t offset, std::size_t length) noexcept {
  if (length > frame.data.size() || body.size() < offset + length) return false;
  std::memcpy(frame.data.data(), body.data() + offset, length);
  frame.length = static_cast<std::uint8_t>(length);
  return true;
}

bool classic(Body body, CanFrame& frame, std::uint32_t& channel) noexcept {
  if (body.size() < 16) return false;
  channel = at<std::uint16_t>(body, 0);
  set_id(frame, at<std::uint32_t>(body, 4));
  frame.remote = (at<std::uint8_t>(body, 2) & 0x80U) != 0;
  const std::size_t length = std::min<std::size_t>(at<std::uint8_t>(body, 3), 8);
  if (!frame.remote) return copy_data(frame, body, 8, length);
  frame.length = static_cast<std::uint8_t>(length);
  return true;
}

void set_fd(CanFrame& frame, bool fd, bool bit_rate_switch, bool error_state) noexcept {
  frame.fd = fd;
  if (fd)
    frame.fd_flags =
        static_cast<std::uint8_t>((bit_rate_switch ? 1U : 0U) | (error_state ? 2U : 0U));
}

bool fd_message(Body body, CanFrame& frame, std::uint32_t& channel) noexcept {
  if (body.size() < 20) return false;
  channel = at<std::uint16_t>(body, 0);
  set_id(frame, at<std::uint32_t>(body, 4));
  frame.remote = (at<std::uint8_t>(body, 2) & 0x80U) != 0;
  const auto flags = at<std::uint8_t>(body, 13);
  set_fd(frame, (flags & 1U) != 0, (flags & 2U) != 0, (flags & 4U) != 0);
  return frame.remote || copy_data(frame, body, 20, at<std::uint8_t>(body, 14));
}

bool fd_message_64(Body body, CanFrame& frame, std::uint32_t& channel) noexcept {
  if (body.size() < 40) return false;
  channel = at<std::uint8_t>(body, 0);
  set_id(frame, at<std::uint32_t>(body, 4));
  const auto flags = at<std::uint32_t>(body, 12);
  frame.remote = (flags & 0x10U) != 0;
  set_fd(frame, (flags & 0x1000U) != 0, (flags & 0x2000U) != 0, (flags & 0x4000U) != 0);
  return frame.remote || copy_data(frame, body, 40, at<std::uint8_t>(body, 2));
}

}  // namespace

std::optional<BlfBase> read_blf_base(std::span<const char> bytes) noexcept {
  if (std::string_view{bytes.data(), 4} != "LOBJ") return std::nullopt;
  const BlfBase out{little<std::uint32_t>(bytes.data() + 8),
                    little<std::uint32_t>(bytes.data() + 12)};
  if (out.size < kBlfBaseHeader) return std::nullopt;
  return out;
}

BlfKind read_blf_object(std::span<const char> object, CanFrame& frame,
                        std::uint32_t& channel) noexcept {
  frame = {};
  const auto version = at<std::uint16_t>(object, 6);
  const auto type = at<std::uint32_t>(object, 12);
  const bool known = type == kCanMessage || type == kCanMessage2 || type == kCanErrorExt ||
                     type == kCanFdMessage || type == kCanFdMessage64;
  if (!known || version < 1 || version > 2) return BlfKind::kOther;
  const std::size_t header = version == 1 ? 32 : 40;
  if (object.size() < header) return BlfKind::kBad;
  const bool coarse = at<std::uint32_t>(object, 16) == kTenMicroseconds;
  const auto stamp = at<std::uint64_t>(object, 24);
  constexpr auto kMost = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()) / 2;
  if (stamp > (coarse ? kMost / 10000 : kMost)) return BlfKind::kBad;
  frame.time_ns = static_cast<std::int64_t>(coarse ? stamp * 10000 : stamp);
  const Body body = object.subspan(header);
  bool good = false;
  if (type == kCanMessage || type == kCanMessage2) good = classic(body, frame, channel);
  if (type == kCanFdMessage) good = fd_message(body, frame, channel);
  if (type == kCanFdMessage64) good = fd_message_64(body, frame, channel);
  if (type == kCanErrorExt) {
    frame.error = true;
    good = body.size() >= 2;
    if (good) channel = at<std::uint16_t>(body, 0);
  }
  return good ? BlfKind::kFrame : BlfKind::kBad;
}

std::int64_t read_system_time(std::span<const char> bytes) noexcept {
  const auto field = [&](std::size_t i) { return at<std::uint16_t>(bytes, 2 * i); };
  using namespace std::chrono;
  const year_month_day date{year{field(0)}, month{field(1)}, day{field(3)}};
  if (!date.ok() || field(0) < 1980 || field(0) > 2200 || field(4) > 23 || field(5) > 59 ||
      field(6) > 60 || field(7) > 999)
    return 0;
  const std::int64_t days = sys_days{date}.time_since_epoch().count();
  const std::int64_t seconds = ((days * 24 + field(4)) * 60 + field(5)) * 60 + field(6);
  return seconds * hal::kSecondNs + std::int64_t{field(7)} * 1'000'000;
}

}  // namespace dampline::drivers
