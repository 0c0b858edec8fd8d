// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>

#include "dampline/sample/extract.hpp"

namespace dampline {

/// Where one acceleration channel is found among the frames.
struct ChannelConfig {
  std::uint32_t id{0};
  bool extended{false};
  std::int8_t interface_index{-1};  ///< -1: any
  SignalLayout accel{};             ///< physical unit m/s^2
  bool has_counter{false};          ///< false: samples are numbered by their time
  SignalLayout counter{};           ///< counts the channel's samples, any length, wraps to 0
  bool multiplexed{false};          ///< true: only frames whose multiplexor has this value
  SignalLayout multiplexor{};
  std::uint64_t multiplexor_value{0};
};

/// Raw codes at which a channel stands at full scale: at or beyond either of them it may have
/// clipped.
struct FullScale {
  std::int64_t low{std::numeric_limits<std::int64_t>::min()};
  std::int64_t high{std::numeric_limits<std::int64_t>::max()};
  [[nodiscard]] constexpr bool reached(std::int64_t raw) const noexcept {
    return raw <= low || raw >= high;
  }
};

/// First and last code of the bit length, or the codes of the stated [minimum|maximum] where those
/// lie inside it. A stated limit within a quarter of a step of a code means that code.
/// Precondition: is_valid(signal) and at most 53 bits, so that codes are exact in a double.
[[nodiscard]] inline FullScale full_scale_of(const SignalLayout& signal) noexcept {
  const auto span = std::int64_t{1} << (signal.is_signed ? signal.length - 1 : signal.length);
  FullScale codes{signal.is_signed ? -span : 0, span - 1};
  if (!(signal.minimum < signal.maximum)) return codes;
  double low = (signal.minimum - signal.offset) / signal.scale;
  double high = (signal.maximum - signal.offset) / signal.scale;
  if (low > high) std::swap(low, high);
  low = std::floor(low + 0.25);
  high = std::ceil(high - 0.25);
  if (low > static_cast<double>(codes.low)) codes.low = static_cast<std::int64_t>(low);
  if (high < static_cast<double>(codes.high)) codes.high = static_cast<std::int64_t>(high);
  return codes;
}

/// False where the assembler could not use the channel.
[[nodiscard]] constexpr bool is_valid(const ChannelConfig& channel) noexcept {
  const std::uint32_t id_limit = channel.extended ? 0x1FFFFFFFU : 0x7FFU;
  if (channel.id > id_limit || !is_valid(channel.accel) || channel.accel.length > 53) return false;
  if (channel.has_counter && !is_valid(channel.counter)) return false;
  return !channel.multiplexed || is_valid(channel.multiplexor);
}

}  // namespace dampline
