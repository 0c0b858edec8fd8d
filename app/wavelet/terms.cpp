// SPDX-License-Identifier: MIT
#include "app/wavelet/terms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>
#include <system_error>

#include "app/error.hpp"
#include "published/wavelet/terms.hpp"

namespace dampline::app::wavelet {
namespace {

constexpr int kHighestPower = 9;

double power(double base, int exponent) noexcept {
  double out = 1.0;
  for (int i = 0; i < exponent; ++i) out *= base;
  return out;
}

double sign_value(const RunTimeTerm& term, double v) noexcept {
  switch (term.sign) {
    case SignKind::kExact:
      return ExactSign{}(v);
    case SignKind::kTanh:
      return TanhSign{term.sharpness_spm}(v);
    case SignKind::kErf:
      return ErfSign{term.sharpness_spm}(v);
    case SignKind::kAtan:
      return AtanSign{term.sharpness_spm}(v);
    case SignKind::kRational:
      return RationalSign{term.sharpness_spm}(v);
    case SignKind::kRoot:
      return RootSign{term.sharpness_spm}(v);
  }
  return 0.0;
}

struct SignName {
  SignKind kind;
  std::string_view name;
};
constexpr std::array kSignNames{SignName{SignKind::kTanh, "tanh"}, SignName{SignKind::kErf, "erf"},
                                SignName{SignKind::kAtan, "atan"},
                                SignName{SignKind::kRational, "rational"},
                                SignName{SignKind::kRoot, "root"}};

/// A text that is read from its beginning. What does not fit leaves it where it was.
class Reader {
 public:
  explicit Reader(std::string_view text) : text_{text} {}
  [[nodiscard]] bool done() const noexcept { return text_.empty(); }
  bool take(std::string_view word) noexcept {
    if (text_.substr(0, word.size()) != word) return false;
    text_.remove_prefix(word.size());
    return true;
  }
  template <class Number>
  std::optional<Number> number() noexcept {
    Number value{};
    const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), value);
    if (error != std::errc{}) return std::nullopt;
    text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
    return value;
  }

 private:
  std::string_view text_;
};

std::optional<double> positive(Reader& reader) noexcept {
  const auto value = reader.number<double>();
  return value && std::isfinite(*value) && *value > 0.0 ? value : std::nullopt;
}

/// "sign(v)", "tanh(1500*v)", "root(v;0.001)".
bool read_sign(Reader& reader, RunTimeTerm& term) noexcept {
  if (reader.take("sign(v)")) return true;
  for (const SignName& s : kSignNames) {
    if (!reader.take(s.name)) continue;
    term.sign = s.kind;
    if (!reader.take("(")) return false;
    if (s.kind == SignKind::kRoot && !reader.take("v;")) return false;
    const auto value = positive(reader);
    if (!value) return false;
    term.sharpness_spm = *value;
    if (s.kind != SignKind::kRoot && !(reader.take("*"), reader.take("v"))) return false;
    return reader.take(")");
  }
  return false;
}

std::optional<RunTimeTerm> read_friction(std::string_view text) noexcept {
  Reader reader{text};
  RunTimeTerm term{.kind = TermKind::kFriction};
  if (reader.take("|x|")) {
    term.kind = TermKind::kProgressiveFriction;
    reader.take("*");
  } else if (reader.take("exp(-")) {
    term.kind = TermKind::kExponentialFriction;
    const auto rate = positive(reader);
    if (!rate || !(reader.take("*"), reader.take("|v|)"))) return std::nullopt;
    term.rate_spm = *rate;
    reader.take("*");
  }
  if (!read_sign(reader, term) || !reader.done()) return std::nullopt;
  return term;
}

/// "x^2*v", "xv", "1", "a".
std::optional<RunTimeTerm> read_power(std::string_view text) noexcept {
  if (text == "a") return RunTimeTerm{.kind = TermKind::kInertia};
  if (text == "1") return RunTimeTerm{};
  Reader reader{text};
  RunTimeTerm term;
  while (!reader.done()) {
    const bool deflection = reader.take("x");
    if (!deflection && !reader.take("v")) return std::nullopt;
    int exponent = 1;
    if (reader.take("^")) exponent = reader.number<int>().value_or(0);
    int& sum = deflection ? term.deflection_power : term.velocity_power;
    if (exponent < 1 || exponent > kHighestPower || sum + exponent > kHighestPower)
      return std::nullopt;
    sum += exponent;
    if (reader.take("*") && reader.done()) return std::nullopt;
  }
  return term.deflection_power + term.velocity_power > 0 ? std::optional{term} : std::nullopt;
}

std::string plain(std::string_view text) {
  std::string out;
  for (const char c : text)
    if (std::isspace(static_cast<unsigned char>(c)) == 0)
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

std::string factor_text(const char* name, int exponent) {
  return exponent == 1 ? std::string{name} : fmt::format("{}^{}", name, exponent);
}

std::string sign_text(const RunTimeTerm& term) {
  if (term.sign == SignKind::kExact) return "sign(v)";
  if (term.sign == SignKind::kRoot) return fmt::format("root(v;{:g})", term.sharpness_spm);
  for (const SignName& s : kSignNames)
    if (s.kind == term.sign) return fmt::format("{}({:g}*v)", s.name, term.sharpness_spm);
  return "";
}

RunTimeTerm monomial(int deflection_power, int velocity_power) {
  return {.deflection_power = deflection_power, .velocity_power = velocity_power};
}

/// m^length s^time beside a leading unit: "N s/m", "kg/m^2", "1/s^2".
std::string dimension(const std::string& leading, int length, int time) {
  std::string above = leading;
  std::string below;
  for (const auto& [name, exponent] : {std::pair{"m", length}, std::pair{"s", time}}) {
    if (exponent == 0) continue;
    std::string& side = exponent > 0 ? above : below;
    side += fmt::format("{}{}", side.empty() ? "" : " ", factor_text(name, std::abs(exponent)));
  }
  if (above.empty()) above.push_back('1');
  return below.empty() ? above : fmt::format("{}/{}", above, below);
}

}  // namespace

double RunTimeTerm::operator()(double x, double v) const noexcept {
  switch (kind) {
    case TermKind::kPower:
      return power(x, deflection_power) * power(v, velocity_power);
    case TermKind::kFriction:
      return sign_value(*this, v);
    case TermKind::kProgressiveFriction:
      return std::abs(x) * sign_value(*this, v);
    case TermKind::kExponentialFriction:
      return std::exp(-rate_spm * std::abs(v)) * sign_value(*this, v);
    case TermKind::kInertia:
      return 0.0;
  }
  return 0.0;
}

bool RunTimeTerm::kink_at_rest() const noexcept {
  return kind != TermKind::kPower && kind != TermKind::kInertia && sign == SignKind::kExact;
}

std::string text_of(const RunTimeTerm& term) {
  switch (term.kind) {
    case TermKind::kInertia:
      return "a";
    case TermKind::kFriction:
      return sign_text(term);
    case TermKind::kProgressiveFriction:
      return "|x|*" + sign_text(term);
    case TermKind::kExponentialFriction:
      return fmt::format("exp(-{:g}*|v|)*{}", term.rate_spm, sign_text(term));
    case TermKind::kPower:
      break;
  }
  std::string out;
  if (term.deflection_power > 0) out = factor_text("x", term.deflection_power);
  if (term.velocity_power > 0)
    out += fmt::format("{}{}", out.empty() ? "" : "*", factor_text("v", term.velocity_power));
  return out.empty() ? "1" : out;
}

std::string name_of(const RunTimeTerm& term) {
  struct Named {
    RunTimeTerm term;
    const char* name{""};
  };
  static const std::array names{
      Named{monomial(0, 1), "viscous"},
      Named{monomial(1, 0), "stiffness"},
      Named{monomial(0, 0), "offset"},
      Named{monomial(2, 0), "quadratic_stiffness"},
      Named{monomial(3, 0), "cubic_stiffness"},
      Named{{.kind = TermKind::kFriction}, "coulomb"},
      Named{{.kind = TermKind::kProgressiveFriction}, "progressive_friction_slope"},
      Named{{.kind = TermKind::kInertia}, "moving_mass"}};
  for (const Named& named : names)
    if (named.term == term) return named.name;
  return text_of(term);
}

std::string unit_of(const RunTimeTerm& term, bool per_mass) {
  if (term.kind == TermKind::kInertia) return per_mass ? "1" : "kg";
  const bool power = term.kind == TermKind::kPower;
  int length = power ? -term.deflection_power - term.velocity_power : 0;
  int time = power ? term.velocity_power : 0;
  if (term.kind == TermKind::kProgressiveFriction) length = -1;
  if (!per_mass) return dimension("N", length, time);
  return dimension("", length + 1, time - 2);
}

std::vector<RunTimeTerm> parse_terms(std::string_view text) {
  std::vector<RunTimeTerm> out;
  const std::string all = plain(text);
  std::size_t from = 0;
  while (from <= all.size()) {
    const std::size_t to = std::min(all.find(',', from), all.size());
    const std::string word = all.substr(from, to - from);
    std::optional<RunTimeTerm> term = read_power(word);
    if (!term) term = read_friction(word);
    if (!term)
      throw UsageError{
          fmt::format("--terms: found '{}', expected terms, with commas between, of\n{}", word,
                      vocabulary_text())};
    if (std::find(out.begin(), out.end(), *term) != out.end())
      throw UsageError{fmt::format("--terms: found '{}' twice", text_of(*term))};
    out.push_back(*term);
    from = to + 1;
  }
  return out;
}

std::string vocabulary_text() {
  return "  1                          a constant force\n"
         "  x, v, x^3, x^2*v, ...      powers of deflection and velocity, each up to 9\n"
         "  sign(v)                    Coulomb friction; or one of the smooth signs\n"
         "  tanh(A*v), erf(A*v), atan(A*v), rational(A*v)   with A in s/m\n"
         "  root(v;W)                  v / sqrt(v^2 + W^2), W in m/s\n"
         "  |x|*sign(v)                friction that grows with deflection; any sign\n"
         "  exp(-A*|v|)*sign(v)        friction that changes with speed; any sign\n"
         "  a                          acceleration: the mass is identified too";
}

const std::vector<RunTimeTerm>& usual_terms() {
  static const std::vector<RunTimeTerm> all =
      parse_terms("1, v, x, x^2, x^3, x*v, v^2, x^2*v, v^3, sign(v), |x|*sign(v)");
  return all;
}

Sensitivities sensitivities_of(const RunTimeTerm& term) {
  Sensitivities out;
  const auto add = [&](int m, int n) {
    if (m >= 0 && n >= 0 && m + n > 0) out.terms[out.count++] = monomial(m, n);
  };
  if (term.kind == TermKind::kPower) {
    if (term.deflection_power > 0) add(term.deflection_power - 1, term.velocity_power);
    if (term.velocity_power > 0) add(term.deflection_power, term.velocity_power - 1);
  }
  return out;
}

}  // namespace dampline::app::wavelet
