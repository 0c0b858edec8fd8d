// SPDX-License-Identifier: MIT
#pragma once
#include <string_view>

#include "dampline/sample/channel.hpp"
#include "drivers/dbc/parse.hpp"

namespace dampline::drivers {

/// One acceleration channel as a DBC file describes it, in m/s^2 (units g and mg are converted).
/// `accel` and `counter` are MESSAGE.SIGNAL; an empty counter is guessed by guess_counter().
/// Errors: a name that is not there, a signal outside its message, of floating point, multiplexed
/// at several levels, longer than 53 bits, or whose unit is no acceleration; a counter elsewhere
/// than in the acceleration's message.
Outcome<ChannelConfig> channel_from(const Dbc& dbc, std::string_view accel,
                                    std::string_view counter);

/// The unsigned signal of the message whose name contains COUNTER, CNT, SEQ or ALIVE, in this order
/// of preference, whatever the case; null when there is none. Signals of another multiplexor value
/// than that of `beside` do not count.
const DbcSignal* guess_counter(const DbcMessage& message, const DbcSignal& beside);

}  // namespace dampline::drivers
