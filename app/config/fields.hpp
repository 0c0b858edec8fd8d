// SPDX-License-Identifier: MIT
#pragma once
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "app/config/config.hpp"

namespace dampline::app {

/// Inclusive limits of a number.
struct Limits {
  double minimum{0.0};
  double maximum{0.0};
};

struct NumberField {
  double* value;
  Limits limits;
};

struct IntegerField {
  int* value;
  Limits limits;
};

/// `absent_word` is what a file may say instead of a number; empty: leave the key out. `choices`
/// not empty: only these values within the limits.
struct OptionalNumberField {
  std::optional<double>* value;
  Limits limits;
  std::string_view absent_word;
  std::span<const double> choices{};
};

/// `allowed` empty: any text.
struct TextField {
  std::string* value;
  std::span<const std::string_view> allowed;
};

struct TextListField {
  std::vector<std::string>* value;
  std::span<const std::string_view> allowed;
};

/// None, or exactly `count` ascending numbers.
struct NumberListField {
  std::vector<double>* value;
  Limits limits;
  std::size_t count;
};

/// One key of the configuration file, bound to one member of a Config.
struct Field {
  std::string_view table;  ///< "input.can"
  std::string_view key;
  std::string_view help;  ///< what it means, with the unit
  std::variant<NumberField, IntegerField, OptionalNumberField, TextField, TextListField,
               NumberListField>
      target;
};

/// Every key there is, in the order in which it is shown. Valid as long as `config` stays in place.
[[nodiscard]] std::vector<Field> fields(Config& config);

}  // namespace dampline::app
