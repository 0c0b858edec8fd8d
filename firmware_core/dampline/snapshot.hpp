// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/motion/motion.hpp"

namespace dampline {

/// A number and its standard deviation, in the same unit.
struct Estimate {
  double value{0.0};
  double std{0.0};
};

inline constexpr std::size_t kCurveSegments = 8;

/// One node of the damping curve. The curve is odd: accelerations alone do not show an asymmetry.
struct CurvePoint {
  double velocity_mps{0.0};
  double force_n{0.0};
  double std_n{0.0};
  std::uint64_t samples{0};  ///< samples whose velocity is nearer to this node than to another
};

/// Level of friction and stiffness at one moment.
struct Level {
  bool valid{false};  ///< false: too little data
  Estimate coulomb_n;
  Estimate stiffness_npm;
};

/// What was taken in and what was left out, in samples unless said otherwise. Monotone.
struct Counts {
  std::uint64_t samples{0};          ///< given to update()
  std::uint64_t gaps{0};             ///< jumps of the tick
  std::uint64_t lost{0};             ///< ticks that were jumped over
  std::uint64_t saturated{0};        ///< with a channel at full scale
  std::uint64_t stuck{0};            ///< with a channel that held one value while another moved
  std::uint64_t not_finite{0};       ///< NaN or infinite
  std::uint64_t repeated{0};         ///< tick not larger than the one before; ignored
  std::uint64_t blocks{0};           ///< completed blocks
  std::uint64_t blocks_excluded{0};  ///< hold a gap, saturation, a stuck channel or no number
  std::uint64_t blocks_still{0};     ///< standstill: no row passed the excitation gate
  std::uint64_t rows{0};             ///< Galerkin rows that were used
  std::uint64_t rows_still{0};       ///< dropped by the excitation gate
};

/// Everything known at one moment. Made on demand from the sufficient statistics.
struct Snapshot {
  bool valid{false};       ///< false: too little data for any of what follows
  std::int64_t tick{0};    ///< newest sample
  Estimate coulomb_n;      ///< Fc = (F1 + F2) / 2
  Estimate stiffness_npm;  ///< k in M z_b'' + k y + F = 0
  Estimate law_width_mps;  ///< w in F = Fc erf(0.8862 v / w): velocity error, rounding of the law
  double nmse{0.0};        ///< of the rows, fitted
  double held_out_nmse{0.0};  ///< of the rows, five interleaved folds of blocks
  /// The same of the model that has a viscous part c v beside the other terms.
  Estimate viscous_nspm;
  Estimate coulomb_with_viscous_n;
  Estimate stiffness_with_viscous_npm;
  Estimate law_width_with_viscous_mps;
  double nmse_with_viscous{0.0};
  double held_out_nmse_with_viscous{0.0};
  bool std_with_viscous_is_lower_bound{false};
  std::array<CurvePoint, kCurveSegments>
      curve{};  ///< nodes for v > 0; the branch v < 0 is its mirror image
  std::array<std::uint64_t, kCurveSegments> samples_negative{};  ///< support of the mirror image
  double curve_force_at_zero_n{0.0};  ///< jump of the broken line at v = 0
  double curve_std_at_zero_n{0.0};
  double velocity_rms_mps{0.0};
  double stick_share{0.0};         ///< share of moving time with |v| < 2 mm/s
  double noise_mps2{0.0};          ///< sensor noise of one channel, rms, from the band above 120 Hz
  double excitation{0.0};          ///< share of blocks that moved
  bool std_is_lower_bound{false};  ///< outside the range where the stated deviations were validated
  std::uint32_t blocks_in_estimate{0};
  Counts counts;
};

}  // namespace dampline
