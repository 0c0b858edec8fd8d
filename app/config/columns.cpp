// SPDX-License-Identifier: MIT
#include "app/config/columns.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <span>
#include <vector>

#include "dampline/sample.hpp"

namespace dampline::app {
namespace {

constexpr double kInchM = 0.0254;
constexpr double kPoundN = 4.4482216152605;

struct Unit {
  Quantity quantity;
  std::string_view name;
  double factor;
};
constexpr std::array kUnits{Unit{Quantity::kTime, "s", 1.0},
                            Unit{Quantity::kTime, "sec", 1.0},
                            Unit{Quantity::kTime, "secs", 1.0},
                            Unit{Quantity::kTime, "second", 1.0},
                            Unit{Quantity::kTime, "seconds", 1.0},
                            Unit{Quantity::kTime, "ms", 1e-3},
                            Unit{Quantity::kTime, "msec", 1e-3},
                            Unit{Quantity::kTime, "us", 1e-6},
                            Unit{Quantity::kTime, "ns", 1e-9},
                            Unit{Quantity::kTime, "min", 60.0},
                            Unit{Quantity::kDeflection, "m", 1.0},
                            Unit{Quantity::kDeflection, "cm", 1e-2},
                            Unit{Quantity::kDeflection, "mm", 1e-3},
                            Unit{Quantity::kDeflection, "um", 1e-6},
                            Unit{Quantity::kDeflection, "micron", 1e-6},
                            Unit{Quantity::kDeflection, "in", kInchM},
                            Unit{Quantity::kDeflection, "inch", kInchM},
                            Unit{Quantity::kVelocity, "m/s", 1.0},
                            Unit{Quantity::kVelocity, "mps", 1.0},
                            Unit{Quantity::kVelocity, "cm/s", 1e-2},
                            Unit{Quantity::kVelocity, "mm/s", 1e-3},
                            Unit{Quantity::kVelocity, "mmps", 1e-3},
                            Unit{Quantity::kVelocity, "in/s", kInchM},
                            Unit{Quantity::kVelocity, "ips", kInchM},
                            Unit{Quantity::kForce, "n", 1.0},
                            Unit{Quantity::kForce, "kn", 1e3},
                            Unit{Quantity::kForce, "lb", kPoundN},
                            Unit{Quantity::kForce, "lbf", kPoundN},
                            Unit{Quantity::kForce, "kip", 1e3 * kPoundN},
                            Unit{Quantity::kForce, "kips", 1e3 * kPoundN},
                            Unit{Quantity::kForce, "kgf", kStandardGravityMps2},
                            Unit{Quantity::kAccel, "m/s2", 1.0},
                            Unit{Quantity::kAccel, "m/ss", 1.0},
                            Unit{Quantity::kAccel, "mps2", 1.0},
                            Unit{Quantity::kAccel, "mm/s2", 1e-3},
                            Unit{Quantity::kAccel, "g", kStandardGravityMps2},
                            Unit{Quantity::kAccel, "gal", 1e-2}};

struct Word {
  Quantity quantity;
  std::string_view word;
};
constexpr std::array kWords{Word{Quantity::kTime, "time"},
                            Word{Quantity::kTime, "zeit"},
                            Word{Quantity::kTime, "timestamp"},
                            Word{Quantity::kDeflection, "displacement"},
                            Word{Quantity::kDeflection, "disp"},
                            Word{Quantity::kDeflection, "displ"},
                            Word{Quantity::kDeflection, "deflection"},
                            Word{Quantity::kDeflection, "position"},
                            Word{Quantity::kDeflection, "pos"},
                            Word{Quantity::kDeflection, "stroke"},
                            Word{Quantity::kDeflection, "travel"},
                            Word{Quantity::kDeflection, "lvdt"},
                            Word{Quantity::kDeflection, "weg"},
                            Word{Quantity::kVelocity, "velocity"},
                            Word{Quantity::kVelocity, "vel"},
                            Word{Quantity::kVelocity, "speed"},
                            Word{Quantity::kVelocity, "geschwindigkeit"},
                            Word{Quantity::kForce, "force"},
                            Word{Quantity::kForce, "load"},
                            Word{Quantity::kForce, "loadcell"},
                            Word{Quantity::kForce, "kraft"},
                            Word{Quantity::kAccel, "acceleration"},
                            Word{Quantity::kAccel, "accel"},
                            Word{Quantity::kAccel, "acc"},
                            Word{Quantity::kAccel, "beschleunigung"},  // letters last
                            Word{Quantity::kTime, "t"},
                            Word{Quantity::kDeflection, "x"},
                            Word{Quantity::kVelocity, "v"},
                            Word{Quantity::kForce, "f"},
                            Word{Quantity::kAccel, "a"}};

/// What was asked for or computed is not what was measured.
constexpr std::array<std::string_view, 16> kNotMeasured{
    "command", "cmd",     "commanded", "demand",    "target", "setpoint",   "reference", "ref",
    "soll",    "desired", "model",     "predicted", "fit",    "simulation", "sim",       "error"};

/// Units of what no column of the program is.
constexpr std::array<std::string_view, 34> kOtherUnits{
    "v",   "mv",  "uv",  "volt", "volts", "a",   "ma",    "amp",    "%",     "deg",    "rad", "bar",
    "pa",  "kpa", "mpa", "psi",  "hz",    "rpm", "digit", "digits", "count", "counts", "lsb", "raw",
    "adc", "bit", "ohm", "w",    "kw",    "kg",  "degc",  "strain", "um/m",  "mv/v"};

constexpr std::array<std::string_view, 6> kFrameWords{"frame",      "bogie",  "bogieframe",
                                                      "truckframe", "rahmen", "drehgestellrahmen"};
constexpr std::array<std::string_view, 8> kWheelsetWords{
    "wheelset", "ws", "axle", "axlebox", "box", "radsatz", "achslager", "achse"};

/// A letter in the place of two bytes of UTF-8.
std::string with_letter(const std::string& text, std::string_view bytes, char letter) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool here = std::string_view{text}.substr(i).starts_with(bytes);
    out += here ? letter : text[i];
    if (here) i += bytes.size() - 1;
  }
  return out;
}

std::string lowered(std::string_view text) {
  std::string out{text};
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

std::string plain_unit(std::string_view unit) {
  std::string out = lowered(unit);
  out = with_letter(out, "\xC2\xB2", '2');  // superscript two
  out = with_letter(out, "\xC2\xB5", 'u');  // micro sign
  out = with_letter(out, "\xCE\xBC", 'u');  // mu
  std::erase_if(out, [](char c) { return c == ' ' || c == '^' || c == '*' || c == '.'; });
  return out;
}

/// Runs of letters and of digits, in their order.
std::vector<std::string> tokens_of(std::string_view name) {
  std::vector<std::string> out;
  int last = 0;  // 1: a letter, 2: a digit
  for (const char c : lowered(name)) {
    const auto byte = static_cast<unsigned char>(c);
    const int kind = std::isalpha(byte) != 0 ? 1 : std::isdigit(byte) != 0 ? 2 : 0;
    if (kind != 0 && kind != last) out.emplace_back();
    if (kind != 0) out.back() += c;
    last = kind;
  }
  return out;
}

template <std::size_t kCount>
bool is_among(const std::array<std::string_view, kCount>& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::vector<std::string> words_of(std::string_view name) {
  std::vector<std::string> out(1);
  for (const char c : lowered(name)) {
    const bool letter = std::isalpha(static_cast<unsigned char>(c)) != 0;
    if (letter)
      out.back() += c;
    else if (!out.back().empty())
      out.emplace_back();
  }
  return out;
}

std::optional<Quantity> quantity_of(std::string_view name) {
  const std::vector<std::string> words = words_of(name);
  const auto has = [&](std::string_view word) {
    return std::find(words.begin(), words.end(), word) != words.end();
  };
  if (std::any_of(kNotMeasured.begin(), kNotMeasured.end(), has)) return std::nullopt;
  for (const Word& w : kWords)
    if (has(w.word)) return w.quantity;
  return std::nullopt;
}

struct NameAndUnit {
  std::string_view name;
  std::string_view unit;
};

/// The unit where the name sets it apart: brackets, "in", a slash; otherwise the longest ending
/// after an underscore or a blank that is a unit.
NameAndUnit parts_of(std::string_view cell) {
  for (const char* pair : {"[]", "()"}) {
    const std::size_t from = cell.rfind(pair[0]);
    const std::size_t to = cell.rfind(pair[1]);
    if (from != std::string_view::npos && to != std::string_view::npos && to > from)
      return {cell.substr(0, from), cell.substr(from + 1, to - from - 1)};
  }
  if (const std::size_t at = cell.find(" in "); at != std::string_view::npos)
    return {cell.substr(0, at), cell.substr(at + 4)};
  for (std::size_t at = cell.find_first_of("_ /,"); at != std::string_view::npos;
       at = cell.find_first_of("_ /,", at + 1)) {
    const NameAndUnit parts{cell.substr(0, at), cell.substr(at + 1)};
    std::string unit{parts.unit};
    std::replace(unit.begin(), unit.end(), '_', '/');
    const auto quantity = quantity_of(parts.name);
    if (quantity && (unit_factor(*quantity, parts.unit) || unit_factor(*quantity, unit)))
      return parts;
  }
  return {cell, {}};
}

bool is_known_unit(std::string_view unit) {
  const std::string plain = plain_unit(unit);
  return std::any_of(kUnits.begin(), kUnits.end(),
                     [&](const Unit& known) { return known.name == plain; });
}

}  // namespace

std::optional<double> unit_factor(Quantity quantity, std::string_view unit) {
  if (quantity == Quantity::kForce && unit == "MN") return 1e6;
  if (quantity == Quantity::kForce && unit == "mN") return 1e-3;
  std::string plain = plain_unit(unit);
  std::replace(plain.begin(), plain.end(), '_', '/');
  for (const Unit& u : kUnits)
    if (u.quantity == quantity && u.name == plain) return u.factor;
  return std::nullopt;
}

std::optional<Column> truck_column(std::string_view cell, std::string_view unit) {
  const HeaderName there = read_header_name(cell);
  const std::string_view stated = unit.empty() ? std::string_view{there.unit} : unit;
  const bool accel = unit_factor(Quantity::kAccel, stated).has_value() ||
                     (there.quantity == Quantity::kAccel && !is_known_unit(stated));
  bool frame = false;
  bool wheelset = false;
  std::string number;  // the first one behind a wheelset
  const std::vector<std::string> tokens = tokens_of(parts_of(cell).name);
  for (const std::string& token : tokens) {
    if (is_among(kNotMeasured, token)) return std::nullopt;
    frame = frame || is_among(kFrameWords, token);
    if (wheelset && number.empty() && std::isdigit(static_cast<unsigned char>(token[0])) != 0)
      number = token;
    wheelset = wheelset || is_among(kWheelsetWords, token);
  }
  if (!accel || frame == wheelset) return std::nullopt;
  if (frame) return Column::kFrameAccel;
  if (number == "1") return Column::kWheelset1Accel;
  return number == "2" ? std::optional{Column::kWheelset2Accel} : std::nullopt;
}

bool is_unit_of_other(Quantity quantity, std::string_view unit) {
  if (unit_factor(quantity, unit)) return false;
  return is_known_unit(unit) || is_among(kOtherUnits, plain_unit(unit));
}

HeaderName read_header_name(std::string_view cell) {
  const NameAndUnit parts = parts_of(cell);
  HeaderName out{quantity_of(parts.name), std::string{parts.unit}, std::nullopt};
  if (out.quantity && !out.unit.empty()) out.factor = unit_factor(*out.quantity, out.unit);
  return out;
}

}  // namespace dampline::app
