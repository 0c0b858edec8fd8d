// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <cstdint>

#include "dampline/numeric/information.hpp"
#include "dampline/phase/stroboscope.hpp"
#include "dampline/snapshot.hpp"

namespace dampline {

/// Columns y, v, sgn v, y sgn v, y^3, and a less its known input.
using PlanarityFactor = Information<6>;

struct PlanaritySums {
  std::uint64_t points{0};
  std::uint64_t not_finite{0};
  std::uint64_t slow{0};
  std::uint64_t nuisances{0};  ///< constants that the regimes took
  double sum_y{0.0};
  double sum_v{0.0};
  PlanarityFactor::Row squares = PlanarityFactor::Row::Zero();  ///< of each column
  void add(const PhasePoint& p, const PlanarityFactor::Row& row) noexcept;
};

enum class PlanarityState : std::uint8_t {
  kNotEnough,      ///< fewer than 30 points beyond the unknowns
  kNoMotion,       ///< deflection or velocity is constant: nothing to test
  kNotDetermined,  ///< none of the three terms can be told from the plane
  kLinear,
  kNonlinear
};

/// Above this F a section is not plane. Noise in the regressors (errors in variables) lifts the F
/// of a linear system to about 5 at 5 % noise; the textbook's 3.8 would reject those.
inline constexpr double kPlanarityThreshold = 10.0;
/// And the three terms must take away this share of the residual's variance: the effect of noise
/// in the regressors on F grows with the number of points, this share does not.
inline constexpr double kPlanarityLeastGain = 0.01;

struct PlanarityVerdict {
  PlanarityState state{PlanarityState::kNotEnough};
  double index{0.0};  ///< rms distance from the plane over rms a: non-planarity
  double f{0.0};      ///< F of the three terms
  double gain{0.0};   ///< share of the residual's variance that they take away
  int terms{0};       ///< how many of the three the data determine
  std::uint64_t points{0};
  std::uint64_t slow{0};        ///< left out: no motion, or too little
  std::uint64_t not_finite{0};  ///< left out
  /// Of the extended regression a = p + k y + h v + s sgn v + t y sgn v + u y^3; deviation 0: not
  /// determined.
  Estimate deflection_per_s2{}, velocity_per_s{}, sign_mps2{}, deflection_sign_per_s2{},
      cubic_per_m2s2{};
};

[[nodiscard]] PlanarityFactor::Row planarity_row(const PhasePoint& p, double input_mps2) noexcept;
[[nodiscard]] PlanarityVerdict judge_planarity(const PlanarityFactor& total,
                                               const PlanaritySums& sums) noexcept;

/// Test whether stroboscopic sections are plane, as they are for a linear system: at a fixed phase
/// of the input, a = p - c v - k y with a constant p.
///
/// The regression a = p(phase) + h v + k y is set against the one that has sgn v, y sgn v and y^3
/// besides, by an F-test; Harmonics harmonics of the phase stand for an unknown periodic input
/// (0: the input is known and given, or sections at one phase; 1: a sinusoid of unknown amplitude,
/// phase and mean; phases / 2 - 1 or more: anything periodic). Sections at one phase hardly show
/// dry friction, since the velocity keeps its sign there and p absorbs the jump: take several
/// phases, at least two of them half a period apart.
///
/// A regime is a stretch with one input; each has a p of its own, which end_regime() eliminates
/// exactly. Any number of regimes fit into the same memory.
template <int Harmonics>
class PlanarityTest {
  static_assert(Harmonics >= 0);

 public:
  /// Points slower than `least_speed_mps` are left out: noise may have turned their sign, and stuck
  /// ones say nothing of the law. kMovingSigmas times the velocity's noise serves well.
  explicit PlanarityTest(double least_speed_mps = 0.0) noexcept
      : least_speed_mps_{least_speed_mps} {}

  static constexpr int kNuisance = 1 + 2 * Harmonics;

  /// `phase_rad`: the input's phase at the point; `input_mps2`: the known part of the input per
  /// unit of mass, 0 if unknown. Points that are no number are counted and left out.
  void add(const PhasePoint& p, double phase_rad, double input_mps2 = 0.0) noexcept {
    if (!is_finite(p) || !std::isfinite(phase_rad) || !std::isfinite(input_mps2)) {
      ++sums_.not_finite;
      return;
    }
    if (!(std::abs(p.velocity_mps) > least_speed_mps_)) {
      ++sums_.slow;
      return;
    }
    typename Regime::Row row;
    row[0] = 1.0;
    for (int h = 0; h < Harmonics; ++h) {
      row[1 + 2 * h] = std::cos((h + 1) * phase_rad);
      row[2 + 2 * h] = std::sin((h + 1) * phase_rad);
    }
    const PlanarityFactor::Row tail = planarity_row(p, input_mps2);
    for (int i = 0; i < PlanarityFactor::kColumns; ++i) row[kNuisance + i] = tail[i];
    regime_.absorb(row);
    sums_.add(p, tail);
    ++in_regime_;
  }

  /// The input changes: what comes has another constant.
  void end_regime() noexcept {
    if (in_regime_ == 0) return;
    close(total_, sums_);
    regime_.clear();
    in_regime_ = 0;
  }

  /// Not for the sample path.
  [[nodiscard]] PlanarityVerdict verdict() const noexcept {
    PlanarityFactor total = total_;
    PlanaritySums sums = sums_;
    if (in_regime_ > 0) close(total, sums);
    return judge_planarity(total, sums);
  }

 private:
  using Regime = Information<kNuisance + PlanarityFactor::kColumns>;

  /// Rows below the nuisance columns of a triangular factor are free of them.
  void close(PlanarityFactor& total, PlanaritySums& sums) const noexcept {
    for (int i = 0; i < kNuisance; ++i)
      if (regime_.at(i, i) > 1e-9 * regime_.column_norm(i)) ++sums.nuisances;
    for (int i = 0; i < PlanarityFactor::kColumns; ++i) {
      PlanarityFactor::Row row = PlanarityFactor::Row::Zero();
      for (int j = i; j < PlanarityFactor::kColumns; ++j)
        row[j] = regime_.at(kNuisance + i, kNuisance + j);
      total.absorb(row, i);
    }
  }

  double least_speed_mps_{0.0};
  Regime regime_;
  PlanarityFactor total_;
  PlanaritySums sums_;
  std::uint64_t in_regime_{0};
};

}  // namespace dampline
