// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "app/config/config.hpp"
#include "app/config/fields.hpp"
#include "app/text/toml_text.hpp"

namespace dampline::app {
namespace {

/// Shortest text that reads back to the same double, and as a TOML float.
std::string write(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string write(int value) { return fmt::format("{}", value); }

std::string write(const std::string& value) { return toml_string(value); }

template <class T>
std::string write(const std::vector<T>& values) {
  std::string text;
  for (const T& value : values) text += (text.empty() ? "" : ", ") + write(value);
  return "[" + text + "]";
}

/// The value as TOML; empty when the key is to be left out.
template <class Target>
std::string write_value(const Target& target) {
  return write(*target.value);
}

template <>
std::string write_value(const OptionalNumberField& target) {
  if (*target.value) return write(**target.value);
  return target.absent_word.empty() ? "" : write(std::string{target.absent_word});
}

}  // namespace

std::string show_config(const Config& config) {
  Config copy = config;
  std::string out;
  std::string_view table;
  for (const Field& field : fields(copy)) {
    if (field.table != table) out += fmt::format("{}[{}]\n", out.empty() ? "" : "\n", field.table);
    table = field.table;
    const std::string value =
        std::visit([](const auto& target) { return write_value(target); }, field.target);
    const std::string line =
        value.empty() ? fmt::format("# {} =", field.key) : fmt::format("{} = {}", field.key, value);
    out += fmt::format("{:<36} # {}\n", line, field.help);
  }
  return out;
}

}  // namespace dampline::app
