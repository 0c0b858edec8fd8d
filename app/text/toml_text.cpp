// SPDX-License-Identifier: MIT
#include "app/text/toml_text.hpp"

#include <fmt/format.h>

namespace dampline::app {

std::string toml_string(std::string_view text) {
  constexpr unsigned char kDelete = 0x7f;
  std::string out = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (code < 0x20 || code == kDelete) {
      out += fmt::format("\\u{:04X}", code);
    } else {
      out += c;
    }
  }
  return out + '"';
}

}  // namespace dampline::app
