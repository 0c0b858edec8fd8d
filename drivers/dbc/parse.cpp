// SPDX-License-Identifier: MIT
#include "drivers/dbc/parse.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "drivers/record/identifier.hpp"
#include "drivers/text/cursor.hpp"
#include "drivers/text/quote.hpp"
#include "drivers/text/whole_file.hpp"

namespace dampline::drivers {
namespace {

/// Reads one line of a DBC file piece by piece. A piece that is not there leaves the cursor in
/// place.
class Cursor {
 public:
  explicit Cursor(std::string_view line) : rest_{line} {}

  void skip_blanks() {
    while (!rest_.empty() && std::isspace(static_cast<unsigned char>(rest_.front())) != 0)
      rest_.remove_prefix(1);
  }
  bool take(char wanted) {
    skip_blanks();
    if (rest_.empty() || rest_.front() != wanted) return false;
    rest_.remove_prefix(1);
    return true;
  }
  /// Letters, digits and _; empty when none is there.
  std::string_view take_name() {
    skip_blanks();
    std::size_t length = 0;
    while (length < rest_.size() && is_name(rest_[length])) ++length;
    return take_front(length);
  }
  /// What is between quotes.
  std::optional<std::string_view> take_quoted() {
    if (!take('"')) return std::nullopt;
    const std::size_t end = rest_.find('"');
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view text = take_front(end);
    rest_.remove_prefix(1);
    return text;
  }
  template <class Number>
  std::optional<Number> take_number() {
    skip_blanks();
    std::string_view digits = rest_;
    if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
    Number number{};
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error != std::errc{}) return std::nullopt;
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return number;
  }
  /// What is left, for messages.
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  static bool is_name(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
  }
  std::string_view take_front(std::size_t length) {
    const std::string_view front = rest_.substr(0, length);
    rest_.remove_prefix(length);
    return front;
  }

  std::string_view rest_;
};

/// Walks over the lines of a file. Text in quotes may run over several lines and hide keywords.
class Parser {
 public:
  Parser(std::string_view text, std::string file) : rest_{text} { dbc_.file = std::move(file); }

  Outcome<Dbc> parse() {
    while (!rest_.empty()) {
      const std::string_view line = next_line();
      const bool in_text = in_quotes_;
      if (std::count(line.begin(), line.end(), '"') % 2 != 0) in_quotes_ = !in_quotes_;
      if (!in_text && !statement(line)) return Failure{Errc::kMalformed, std::move(error_)};
    }
    if (dbc_.messages.empty()) {
      return Failure{Errc::kMalformed,
                     fmt::format("{}: no message (BO_) found; expected a DBC file", dbc_.file)};
    }
    return std::move(dbc_);
  }

 private:
  std::string_view next_line() {
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++line_;
    return line;
  }

  bool fail(std::string_view expected, std::string_view found) {
    error_ = fmt::format("{}:{}: found {}, expected {}", dbc_.file, line_, quote(found), expected);
    return false;
  }

  bool statement(std::string_view line) {
    Cursor cursor{line};
    const std::string_view keyword = cursor.take_name();
    if (keyword == "BO_") return message(cursor);
    if (keyword == "SG_") return signal(cursor);
    if (keyword == "SIG_VALTYPE_") value_type(cursor);
    return true;
  }

  // BO_ 2364540158 NAME: 8 SENDER
  bool message(Cursor& cursor) {
    const auto id = cursor.take_number<std::uint32_t>();
    if (!id) return fail("BO_ followed by an identifier", cursor.rest());
    DbcMessage made;
    made.extended = (*id & kExtendedFlag) != 0;
    made.id = *id & kExtendedMask;
    made.name = cursor.take_name();
    if (made.name.empty() || !cursor.take(':'))
      return fail("a message name and a colon", cursor.rest());
    const auto length = cursor.take_number<std::uint32_t>();
    if (!length) return fail("the length of the message in bytes", cursor.rest());
    made.length = *length;
    dbc_.messages.push_back(std::move(made));
    return true;
  }

  // SG_ NAME m3 : 12|12@1- (0.05,0) [-100|100] "m/s^2" RECEIVER
  bool signal(Cursor& cursor) {
    if (dbc_.messages.empty()) return fail("a message (BO_) before its first signal (SG_)", "SG_");
    DbcSignal made;
    made.line = line_;
    made.name = cursor.take_name();
    if (made.name.empty()) return fail("a signal name", cursor.rest());
    if (!multiplexing(cursor.take_name(), made))
      return fail("M, m<number>, m<number>M or a colon", cursor.rest());
    if (!bits(cursor, made.layout) || !scaling(cursor, made.layout)) return false;
    const auto unit = cursor.take_quoted();
    if (!unit) return fail("the unit in quotes", cursor.rest());
    made.unit = *unit;
    dbc_.messages.back().signals.push_back(std::move(made));
    return true;
  }

  static bool multiplexing(std::string_view mark, DbcSignal& made) {
    if (mark.empty()) return true;
    made.multiplexing = Multiplexing::kMultiplexor;
    if (mark == "M") return true;
    made.multiplexing = mark.back() == 'M' ? Multiplexing::kExtended : Multiplexing::kMultiplexed;
    if (mark.back() == 'M') mark.remove_suffix(1);
    if (mark.size() < 2 || mark.front() != 'm') return false;
    const char* end = mark.data() + mark.size();
    const auto result = std::from_chars(mark.data() + 1, end, made.multiplexor_value);
    return result.ec == std::errc{} && result.ptr == end;
  }

  // : 12|12@1-
  bool bits(Cursor& cursor, SignalLayout& layout) {
    if (!cursor.take(':')) return fail("a colon behind the signal name", cursor.rest());
    const auto start = cursor.take_number<std::uint16_t>();
    if (!start || !cursor.take('|')) return fail("start bit and |", cursor.rest());
    const auto length = cursor.take_number<std::uint8_t>();
    if (!length || !cursor.take('@'))
      return fail("a length of at most 255 bits and @", cursor.rest());
    layout.start_bit = *start;
    layout.length = *length;
    layout.order = cursor.take('0') ? ByteOrder::kMotorola : ByteOrder::kIntel;
    if (layout.order == ByteOrder::kIntel && !cursor.take('1'))
      return fail("byte order 0 or 1", cursor.rest());
    layout.is_signed = cursor.take('-');
    if (!layout.is_signed && !cursor.take('+')) return fail("sign + or -", cursor.rest());
    return true;
  }

  // (0.05,0) [-100|100]
  bool scaling(Cursor& cursor, SignalLayout& layout) {
    if (!pair(cursor, "(,)", layout.scale, layout.offset))
      return fail("(scale,offset)", cursor.rest());
    if (!pair(cursor, "[|]", layout.minimum, layout.maximum))
      return fail("[minimum|maximum]", cursor.rest());
    return true;
  }

  static bool pair(Cursor& cursor, std::string_view marks, double& first, double& second) {
    if (!cursor.take(marks[0])) return false;
    const auto one = cursor.take_number<double>();
    if (!one || !std::isfinite(*one) || !cursor.take(marks[1])) return false;
    const auto two = cursor.take_number<double>();
    if (!two || !std::isfinite(*two) || !cursor.take(marks[2])) return false;
    first = *one;
    second = *two;
    return true;
  }

  // SIG_VALTYPE_ 208 NAME : 1;   The list of keywords (NS_) has the bare word, too.
  void value_type(Cursor& cursor) {
    const auto id = cursor.take_number<std::uint32_t>();
    if (!id) return;
    const std::string_view name = cursor.take_name();
    cursor.take(':');
    const auto type = cursor.take_number<int>();
    for (DbcMessage& message : dbc_.messages) {
      if (message.id != (*id & kExtendedMask) || message.extended != ((*id & kExtendedFlag) != 0))
        continue;
      for (DbcSignal& signal : message.signals) {
        if (signal.name == name) signal.is_float = type.value_or(0) != 0;
      }
    }
  }

  std::string_view rest_;
  std::uint64_t line_{0};
  bool in_quotes_{false};
  Dbc dbc_;
  std::string error_;
};

}  // namespace

Outcome<Dbc> parse_dbc(std::string_view text, std::string file) {
  text = without_byte_order_mark(text);
  return Parser{text, std::move(file)}.parse();
}

Outcome<Dbc> load_dbc(const std::string& path) {
  constexpr std::size_t kMostBytes = std::size_t{64} << 20U;  // the largest of a car have 20 MB
  const auto text = read_whole(path, kMostBytes);
  if (!text.ok()) return text.failure();
  if (text.value().empty())
    return Failure{Errc::kMalformed, fmt::format("{}: is empty; expected a DBC file", path)};
  return parse_dbc(text.value(), path);
}

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
