// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

#include "dampline/effect/columns.hpp"
#include "dampline/explanation.hpp"

namespace dampline::effect {

struct Explanation;
struct Step;

/// A stop nearer than that, in rms of y, is the kink of a spring that differs by direction.
inline constexpr double kKinkWithin = 1.0;

/// The one point of a fine grid of decay speeds.
inline constexpr std::size_t kFineStribeck = 1;

/// Where laws that have a length, a speed or a frequency are tabulated.
struct Grids {
  double scale_m{0.0};  ///< the deflection's size, unit of the lengths; 0: to be learnt
  /// Effects whose points stand close around an estimate, so that none lies between two of them.
  std::array<bool, kEffects> fine{};
  std::array<double, kStribeckSpeeds> stribeck_mps{kStribeckMps};  ///< each twice the one before
  std::array<double, kBumpGaps> bump_gap{kBumpGap};
  double kink{0.0};  ///< where a spring that differs by direction bends; the others are lengths
  std::array<double, kDahlDistances> dahl_distance{kDahlDistance};
  std::array<PlayShape, kBacklashGaps> play{play_shapes()};
  std::array<double, kRelaxations> relaxation_s{kRelaxationS};
  std::array<PitchShape, kPitchModes> pitch{kPitch};
  std::array<FlexibleShape, kFlexibleModes> flexible{flexible_shapes()};

  [[nodiscard]] bool is_fine(Effect effect) const noexcept {
    return fine[static_cast<std::size_t>(effect)];
  }
};

/// Modes stand in lines of one slip or damping, frequency after frequency, and gaps in lines of one
/// width: points in a line.
[[nodiscard]] std::size_t line_of(Effect effect, bool is_pitch, const Grids& grids) noexcept;

/// The mode or the play of a step, between the points of its grid.
[[nodiscard]] PitchShape pitch_of(const Step& step, const Grids& grids) noexcept;
[[nodiscard]] FlexibleShape flexible_of(const Step& step, const Grids& grids) noexcept;
[[nodiscard]] PlayShape play_of(const Step& step, const Grids& grids) noexcept;

/// A stop on one side that stands near the middle as a spring that differs by direction, which
/// bends where the truck hangs at rest, and not at the mean of its motion. False: the first effect
/// is none.
bool as_kink(Explanation& explanation) noexcept;

/// The grids of an explanation with those of its effects drawn together around what was found, the
/// more the higher `round` is, from 0. False: none of its effects has a grid.
bool draw_together(const Explanation& explanation, int round, Grids& grids) noexcept;

}  // namespace dampline::effect
