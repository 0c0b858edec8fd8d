// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>

#include "dampline/result.hpp"
#include "dampline/snapshot.hpp"

namespace dampline::rig {

/// A dissipative term: absent, one value for both directions, or one for v > 0 and one for v < 0.
enum class Branches : std::uint8_t { kNone, kCommon, kSeparate };

/// What the force consists of:
///   f = m x'' + c(v) v + k x + F(v) sign v + offset.
struct Terms {
  bool inertia{false};    ///< m, a driven mass
  bool stiffness{false};  ///< k
  Branches viscous{Branches::kNone};
  Branches coulomb{Branches::kCommon};
  bool offset{false};  ///< a constant; not beside separate Coulomb levels, which contain it
};

/// Settings of a Identifier. Survey suggests the ones that the data decide.
struct Config {
  double sample_rate_hz{1000.0};
  double corner_hz{20.0};             ///< -3 dB point of the test function
  double prediction_corner_hz{20.0};  ///< the same for the acceleration in a predicted force
  bool velocity_measured{false};      ///< samples carry velocity_mps; otherwise it is derived
  int velocity_half_width{5};         ///< samples to either side of a derived velocity, 1...32
  bool velocity_sharp{false};         ///< derived by sixth-order differences, three samples wide
  double sign_width_mps{1e-3};        ///< w of the smooth sign erf(0.8862 v / w)
  double still_mps{1e-3};             ///< below it the rig stands still
  std::int64_t block_samples{500};    ///< start value; doubles when the store of blocks is full
  std::array<double, kCurveSegments> curve_nodes_mps{0.0125, 0.025, 0.0375, 0.05,
                                                     0.0625, 0.075, 0.0875, 0.1};
};

/// kInvalidConfig where a value is out of its range (the test function must be 5 to 512 samples to
/// either side, nodes ascending) and for terms that cannot be told apart.
[[nodiscard]] Result<Config> check(const Config& config) noexcept;
[[nodiscard]] Result<Terms> check(const Terms& terms) noexcept;

/// Samples to either side of the test function's centre: (1 - u^2)^5 has its -3 dB point at 0.477 /
/// T and is 0 from T on, its differences three samples later.
[[nodiscard]] int half_support_samples(double corner_hz, double sample_rate_hz) noexcept;
[[nodiscard]] inline int half_support_samples(const Config& config) noexcept {
  return half_support_samples(config.corner_hz, config.sample_rate_hz);
}

inline constexpr int kMinHalfSupport = 5;
inline constexpr int kMaxHalfSupport = 512;
inline constexpr int kMaxVelocityHalfWidth = 32;

}  // namespace dampline::rig
