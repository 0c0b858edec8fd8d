// SPDX-License-Identifier: MIT
#include "drivers/dbc/channel.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

#include "dampline/sample.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::drivers {
namespace {

/// What one unit is in m/s^2; nothing when it is no acceleration. Without a unit: m/s^2.
std::optional<double> unit_mps2(std::string_view unit) {
  if (unit.empty() || unit == "ms-2" || unit == "m s-2" || unit.starts_with("m/s")) return 1.0;
  if (unit == "g" || unit == "G" || unit == "g0" || unit == "gn") return kStandardGravityMps2;
  if (unit == "mg" || unit == "mG") return 1e-3 * kStandardGravityMps2;
  if (unit.starts_with("mm/s")) return 1e-3;
  return std::nullopt;
}

Failure unusable(const Dbc& dbc, const SignalPlace& place, std::string_view found,
                 std::string_view expected) {
  return {Errc::kInvalidConfig,
          fmt::format("{}:{}: {}.{}: found {}, expected {}", dbc.file, place.signal->line,
                      place.message->name, place.signal->name, found, expected)};
}

/// Nothing when the signal can be extracted from its message.
std::optional<Failure> why_not(const Dbc& dbc, const SignalPlace& place, int most_bits) {
  const DbcSignal& signal = *place.signal;
  if (signal.is_float)
    return unusable(dbc, place, "a floating-point signal (SIG_VALTYPE_)", "an integer");
  if (signal.multiplexing == Multiplexing::kExtended) {
    return unusable(dbc, place, "extended multiplexing (m<number>M)", "one level at most");
  }
  if (signal.layout.length < 1 || signal.layout.length > most_bits) {
    return unusable(dbc, place, fmt::format("{} bits", signal.layout.length),
                    fmt::format("1 to {}", most_bits));
  }
  if (!is_valid(signal.layout))
    return unusable(dbc, place, "a scale of 0 or bits beyond byte 63", "a usable layout");
  if (bytes_needed(signal.layout) > static_cast<int>(place.message->length)) {
    return unusable(dbc, place, fmt::format("bits in byte {}", bytes_needed(signal.layout) - 1),
                    fmt::format("all within the message's {} bytes", place.message->length));
  }
  return std::nullopt;
}

/// Nothing when the acceleration stands in every frame of its message, or its multiplexor is known.
std::optional<Failure> set_multiplexor(const Dbc& dbc, const SignalPlace& place,
                                       ChannelConfig& channel) {
  if (place.signal->multiplexing != Multiplexing::kMultiplexed) return std::nullopt;
  const auto& signals = place.message->signals;
  const auto multiplexor = std::find_if(
      signals.begin(), signals.end(),
      [](const DbcSignal& signal) { return signal.multiplexing == Multiplexing::kMultiplexor; });
  if (multiplexor == signals.end()) {
    return unusable(dbc, place, "no multiplexor (M) in its message", "one");
  }
  channel.multiplexed = true;
  channel.multiplexor = multiplexor->layout;
  channel.multiplexor_value = place.signal->multiplexor_value;
  return why_not(dbc, {place.message, &*multiplexor}, 64);
}

std::string upper(std::string_view text) {
  std::string all{text};
  std::transform(all.begin(), all.end(), all.begin(), [](char c) {
    return static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  });
  return all;
}

bool stands_beside(const DbcSignal& signal, const DbcSignal& accel) {
  if (signal.multiplexing == Multiplexing::kNone) return true;
  return signal.multiplexing == Multiplexing::kMultiplexed &&
         accel.multiplexing == Multiplexing::kMultiplexed &&
         signal.multiplexor_value == accel.multiplexor_value;
}

/// Nothing when there is no counter or it can be used.
std::optional<Failure> set_counter(const Dbc& dbc, const SignalPlace& accel, std::string_view name,
                                   ChannelConfig& channel) {
  SignalPlace counter{accel.message, guess_counter(*accel.message, *accel.signal)};
  if (!name.empty()) {
    const Outcome<SignalPlace> found = find_signal(dbc, name);
    if (!found.ok()) return found.failure();
    counter = found.value();
    if (counter.message != accel.message || !stands_beside(*counter.signal, *accel.signal)) {
      return unusable(
          dbc, counter, "a counter in other frames",
          fmt::format("one in the frames of {}.{}", accel.message->name, accel.signal->name));
    }
  }
  if (counter.signal == nullptr) return std::nullopt;
  if (auto failure = why_not(dbc, counter, 64)) return failure;
  channel.has_counter = true;
  channel.counter = counter.signal->layout;
  return std::nullopt;
}

}  // namespace

const DbcSignal* guess_counter(const DbcMessage& message, const DbcSignal& beside) {
  constexpr std::array<std::string_view, 4> kWords{"COUNTER", "CNT", "SEQ", "ALIVE"};
  for (const std::string_view word : kWords) {
    for (const DbcSignal& signal : message.signals) {
      if (&signal == &beside || signal.layout.is_signed || signal.is_float) continue;
      if (stands_beside(signal, beside) && upper(signal.name).find(word) != std::string::npos)
        return &signal;
    }
  }
  return nullptr;
}

Outcome<ChannelConfig> channel_from(const Dbc& dbc, std::string_view accel,
                                    std::string_view counter) {
  const Outcome<SignalPlace> found = find_signal(dbc, accel);
  if (!found.ok()) return found.failure();
  const SignalPlace& place = found.value();
  if (auto failure = why_not(dbc, place, 53)) return *failure;
  const std::optional<double> unit = unit_mps2(place.signal->unit);
  if (!unit)
    return unusable(dbc, place, "unit " + quote(place.signal->unit),
                    "an acceleration: m/s^2, g or mg");
  ChannelConfig channel;
  channel.id = place.message->id;
  channel.extended = place.message->extended;
  channel.accel = place.signal->layout;
  for (double* number : {&channel.accel.scale, &channel.accel.offset, &channel.accel.minimum,
                         &channel.accel.maximum}) {
    *number *= *unit;
  }
  if (auto failure = set_multiplexor(dbc, place, channel)) return *failure;
  if (auto failure = set_counter(dbc, place, counter, channel)) return *failure;
  if (!is_valid(channel))
    return unusable(dbc, place, fmt::format("identifier {}", channel.id), "11 or 29 bits");
  return channel;
}

}  // namespace dampline::drivers
