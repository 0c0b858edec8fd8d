// SPDX-License-Identifier: MIT
#pragma once
#include <cctype>
#include <charconv>
#include <optional>
#include <string_view>

namespace dampline::drivers {

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

}  // namespace dampline::drivers
