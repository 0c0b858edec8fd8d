// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dampline::app::wavelet {

/// The functions of published/wavelet/terms.hpp, to be chosen while the program runs.
enum class TermKind : std::uint8_t {
  kPower,                ///< x^m v^n
  kFriction,             ///< s(v)
  kProgressiveFriction,  ///< |x| s(v)
  kExponentialFriction,  ///< exp(-rate |v|) s(v)
  kInertia,              ///< a: the mass is among the unknowns
};

/// How sign(v) is written; the smooth ones as in Mostaghel and Davis (1997).
enum class SignKind : std::uint8_t { kExact, kTanh, kErf, kAtan, kRational, kRoot };

/// One regressor g(x, v) of the restoring force. A plain value: models hold arrays of it.
struct RunTimeTerm {
  TermKind kind{TermKind::kPower};
  SignKind sign{SignKind::kExact};
  int deflection_power{0};
  int velocity_power{0};
  double sharpness_spm{0.0};  ///< alpha of a smooth sign, s/m; of the root its width, m/s
  double rate_spm{0.0};       ///< of exponential friction, s/m

  /// g(x, v) with x in m, v in m/s. Of inertia 0: a row knows the acceleration.
  [[nodiscard]] double operator()(double x, double v) const noexcept;
  /// Whether g or a derivative of it jumps at v = 0, at x = 0.
  [[nodiscard]] bool kink_at_rest() const noexcept;
  [[nodiscard]] bool kink_at_centre() const noexcept {
    return kind == TermKind::kProgressiveFriction;
  }
  [[nodiscard]] bool operator==(const RunTimeTerm&) const noexcept = default;
};

/// The term as it is written: "x^2*v", "tanh(1500*v)", "|x|*sign(v)". Parses back to itself.
[[nodiscard]] std::string text_of(const RunTimeTerm& term);
/// The parameter's name in parameters.json: that of the same thing elsewhere ("viscous",
/// "stiffness", "coulomb", ...), else the text.
[[nodiscard]] std::string name_of(const RunTimeTerm& term);
/// The parameter's unit, of a force in N ("N s/m", "kg"), or per unit mass ("1/s", "1").
[[nodiscard]] std::string unit_of(const RunTimeTerm& term, bool per_mass);

/// "v, x, x^3, sign(v)". Blanks count for nothing, and so does the case of letters. Throws
/// UsageError: nothing, a term that is not in the vocabulary (which it lists), one that stands
/// twice.
[[nodiscard]] std::vector<RunTimeTerm> parse_terms(std::string_view text);

/// What may stand in --terms, for help and errors.
[[nodiscard]] std::string vocabulary_text();
/// Terms that a comparison adds one by one.
[[nodiscard]] const std::vector<RunTimeTerm>& usual_terms();

/// A function that an error of the deflection or of the velocity multiplies: dg/dx and dg/dv
/// without their factors; constants and what vanishes left out. A term's are at most two.
struct Sensitivities {
  std::array<RunTimeTerm, 2> terms{};
  std::size_t count{0};
};
[[nodiscard]] Sensitivities sensitivities_of(const RunTimeTerm& term);

}  // namespace dampline::app::wavelet
