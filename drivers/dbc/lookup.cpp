// SPDX-License-Identifier: MIT
#include <fmt/core.h>

#include <algorithm>

#include "drivers/dbc/dbc.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::drivers {

Outcome<SignalPlace> find_signal(const Dbc& dbc, std::string_view name) {
  std::vector<std::string> known;
  for (const DbcMessage& message : dbc.messages) {
    for (const DbcSignal& signal : message.signals) {
      known.push_back(message.name + "." + signal.name);
      if (known.back() == name) return SignalPlace{&message, &signal};
    }
  }
  return Failure{
      Errc::kInvalidConfig,
      fmt::format(
          "{}: found no signal {}, expected MESSAGE.SIGNAL; the nearest of its {} signals: {}",
          dbc.file, quote(name), known.size(), nearest_names(name, known.data(), known.size()))};
}

}  // namespace dampline::drivers
