// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "dampline/sample/signal.hpp"
#include "drivers/outcome.hpp"

namespace dampline::drivers {

/// What stands at the name of a signal: nothing, `M`, `m5`, or `m5M` (multiplexed at several
/// levels).
enum class Multiplexing : std::uint8_t { kNone, kMultiplexor, kMultiplexed, kExtended };

struct DbcSignal {
  std::string name;
  SignalLayout layout{};
  std::string unit;
  Multiplexing multiplexing{Multiplexing::kNone};
  std::uint64_t multiplexor_value{0};  ///< kMultiplexed and kExtended
  bool is_float{false};                ///< SIG_VALTYPE_ 1 or 2: the bits are an IEEE number
  std::uint64_t line{0};               ///< where it is defined
};

struct DbcMessage {
  std::string name;
  std::uint32_t id{0};  ///< without the flag bit
  bool extended{false};
  std::uint32_t length{0};  ///< bytes
  std::vector<DbcSignal> signals;
};

/// The messages of a DBC file: BO_, SG_ and SIG_VALTYPE_. All other statements are passed over.
struct Dbc {
  std::string file;  ///< for messages to people
  std::vector<DbcMessage> messages;
};

/// Errors name file and line, what was found and what was expected.
Outcome<Dbc> parse_dbc(std::string_view text, std::string file);
Outcome<Dbc> load_dbc(const std::string& path);

struct SignalPlace {
  const DbcMessage* message{nullptr};
  const DbcSignal* signal{nullptr};
};

/// Looks up "MESSAGE.SIGNAL". When it is absent, the error names the file and the nearest names.
Outcome<SignalPlace> find_signal(const Dbc& dbc, std::string_view name);

}  // namespace dampline::drivers
