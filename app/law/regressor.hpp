// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>

namespace dampline::app::law {

/// A function of a rig's motion. A stop operator of travel r, z = clip(z + dx, -r, r), is what
/// gives friction its memory; u = z / r.
struct Regressor {
  enum class Kind : std::uint8_t {
    kInertia,              ///< x''
    kOne,                  ///< 1
    kDeflection,           ///< x
    kSquare,               ///< x^2
    kCube,                 ///< x^3
    kMagnitude,            ///< |x|
    kBumpUp,               ///< max(x - a, 0)
    kBumpDown,             ///< min(x + a, 0)
    kVelocity,             ///< v
    kAcceleration,         ///< v' by a central difference, where nothing is filtered
    kSpeed,                ///< |v|
    kSpeedSquared,         ///< v |v|
    kSquareVelocity,       ///< x^2 v
    kSign,                 ///< tanh(v / a)
    kFading,               ///< tanh(v / a) exp(-|v| / b): friction that falls with speed
    kFadingSquare,         ///< tanh(v / a) exp(-(v / b)^2)
    kFadingSlowly,         ///< tanh(v / a) / (1 + (v / b)^2)
    kProgressive,          ///< tanh(v / a) x
    kProgressiveAbsolute,  ///< tanh(v / a) |x|
    kAttached,             ///< acceleration of a mass on a spring: a Hz, damping ratio b
    kBoucWen,              ///< z of travel a and shape b, see bouc_wen
    kMaxwell,              ///< z, z' = v - z / a: stretch of a spring behind a dashpot, a in s
    kStop,                 ///< u of travel a
    kGapUp,                ///< max(u, 0)^4 of travel a: no force about the middle
    kGapDown,              ///< -max(-u, 0)^4
    kEdge,                 ///< nothing but the full level at either end of travel a
    kHat,                  ///< broken-line basis over u: the hat about -1 + 2 b / (kHats - 1)
    kFall,                 ///< |v| clip(2 b u - 1, 0, 1), b = +-1: a level that falls with speed
    kBreakaway             ///< |v| exp(-slip / 10 mm) once side b = +-1 slips
  };
  static constexpr int kHats = 11;
  /// What changes over the record: evenly from -1/2 to 1/2, or from 0 to 1 after a share `at`.
  enum class Time : std::uint8_t { kSteady, kSlope, kStep };

  Kind kind{Kind::kOne};
  double a{0.0};
  double b{0.0};
  Time time{Time::kSteady};
  double at{0.0};
};

using Kind = Regressor::Kind;

/// Whether it has a state of its own, of a rate.
[[nodiscard]] constexpr bool has_rate(Kind kind) noexcept {
  return kind == Kind::kBoucWen || kind == Kind::kMaxwell;
}
/// The forms of friction that falls with speed.
inline constexpr std::array kFadingForms{Kind::kFading, Kind::kFadingSquare, Kind::kFadingSlowly};
[[nodiscard]] constexpr bool is_fading(Kind kind) noexcept {
  return std::find(kFadingForms.begin(), kFadingForms.end(), kind) != kFadingForms.end();
}
/// Whether a stop operator is in it.
[[nodiscard]] constexpr bool has_stop(Kind kind) noexcept { return kind >= Kind::kStop; }
/// Of x and v alone, at one instant.
[[nodiscard]] double value_at(const Regressor& column, double x, double v) noexcept;
/// Of the stop operator's u, v, and the way since it slips.
[[nodiscard]] double memory_at(const Regressor& column, double u, double v, double slip_m) noexcept;

}  // namespace dampline::app::law
