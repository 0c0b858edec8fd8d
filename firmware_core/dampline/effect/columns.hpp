// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

namespace dampline::effect {

/// An index of an array as one of columns.
constexpr int at(std::size_t i) noexcept { return static_cast<int>(i); }

inline constexpr std::size_t kWidths = 8;
inline constexpr std::size_t kStribeckSpeeds = 4;
inline constexpr std::size_t kBumpGaps = 7;
inline constexpr std::size_t kDahlDistances = 8;
inline constexpr std::size_t kBacklashGaps = 8;
inline constexpr std::size_t kRelaxations = 5;
inline constexpr std::size_t kPitchModes = 9;
inline constexpr std::size_t kFlexibleModes = 17;

/// Widths of the friction law, m/s.
inline constexpr std::array<double, kWidths> kWidthMps{0.7e-3, 1.0e-3, 1.4e-3, 2.0e-3,
                                                       2.8e-3, 4.0e-3, 5.6e-3, 8.0e-3};
/// The width inside columns that hold a sign and something else.
inline constexpr double kInnerWidthMps = 2.0e-3;
/// Decay speeds of Stribeck friction, m/s; each is twice the one before.
inline constexpr std::array<double, kStribeckSpeeds> kStribeckMps{3.0e-3, 6.0e-3, 12.0e-3, 24.0e-3};
/// Lengths that belong to the deflection's own size, in units of it (Scale).
inline constexpr std::array<double, kBumpGaps> kBumpGap{0.5, 0.8, 1.2, 1.7, 2.3, 3.0, 4.0};
inline constexpr std::array<double, kDahlDistances> kDahlDistance{0.05, 0.08, 0.125, 0.2,
                                                                  0.32, 0.5,  0.8,   1.25};
inline constexpr std::array<double, kBacklashGaps> kBacklashGap{0.1, 0.15, 0.22, 0.33,
                                                                0.5, 0.75, 1.1,  1.7};
/// Free play, and how wide about v = 0 the force of its end stands between none and whole: an end
/// that sticks holds a truck that creeps, with a force that is any of these.
struct PlayShape {
  double gap;  ///< in units of the deflection's size
  double width_mps;
};
/// How far the end of a play yields until its force is whole, from the width that is found, which
/// has the velocity's error in it: an end of F / s stops a mass M of less than sqrt(2 F s / M)
/// before. `force_mps2`: F / M.
constexpr double end_yields_m(double width_mps, double force_mps2) noexcept {
  const double over_m2_s2 = width_mps * width_mps - kInnerWidthMps * kInnerWidthMps;
  return over_m2_s2 > 0.0 && force_mps2 > 0.0 ? 0.5 * over_m2_s2 / force_mps2 : 0.0;
}
constexpr std::array<PlayShape, kBacklashGaps> play_shapes() noexcept {
  std::array<PlayShape, kBacklashGaps> out{};
  for (std::size_t i = 0; i < kBacklashGaps; ++i) out[i] = {kBacklashGap[i], kInnerWidthMps};
  return out;
}
/// Drawn together around a gap, the same points are gaps times widths.
inline constexpr std::size_t kFineGaps = 4;
inline constexpr std::size_t kFinePlayWidths = kBacklashGaps / kFineGaps;
/// Times in which a spring behind a dashpot (Maxwell) gives way, s: corners from 32 to 1.4 Hz,
/// beyond which it is a dashpot or a spring.
inline constexpr std::array<double, kRelaxations> kRelaxationS{0.005, 0.011, 0.024, 0.053, 0.117};
struct PitchShape {
  double frequency_hz;
  double slip_m;  ///< F / (2 k): how far the spring must turn before friction yields
};
/// The frame's pitch on spring and friction of both wheelsets.
inline constexpr double kPitchDamping = 0.02;
inline constexpr std::size_t kPitchFrequencies = 3;
inline constexpr std::array<PitchShape, kPitchModes> kPitch{{{7.5, 0.4e-3},
                                                             {12.0, 0.4e-3},
                                                             {19.0, 0.4e-3},
                                                             {7.5, 0.8e-3},
                                                             {12.0, 0.8e-3},
                                                             {19.0, 0.8e-3},
                                                             {7.5, 1.6e-3},
                                                             {12.0, 1.6e-3},
                                                             {19.0, 1.6e-3}}};
/// A mass on the frame, on a spring.
inline constexpr double kFlexibleDamping = 0.04;
inline constexpr std::array<double, kFlexibleModes> kFlexibleHz{
    5.2, 5.7, 6.3, 6.9, 7.6, 8.4, 9.2, 10.1, 11.1, 12.3, 13.5, 14.8, 16.3, 18.0, 19.8, 21.7, 23.9};
struct FlexibleShape {
  double frequency_hz;
  double damping_ratio;
};
constexpr std::array<FlexibleShape, kFlexibleModes> flexible_shapes() noexcept {
  std::array<FlexibleShape, kFlexibleModes> out{};
  for (std::size_t i = 0; i < kFlexibleModes; ++i) out[i] = {kFlexibleHz[i], kFlexibleDamping};
  return out;
}
/// Drawn together around a frequency, the same points are frequencies times dampings; two are left.
inline constexpr std::size_t kFineFrequencies = 5;
inline constexpr std::size_t kFineDampings = 3;

/// The columns of a diagnosis row, in its order. All are forces per unit of moving mass once
/// multiplied by their coefficient; the target is -z_b''.
enum Column : int {
  kSign = 0,                                                  ///< smooth sign of v, one per width
  kTangent1 = kSign + static_cast<int>(kWidths),              ///< d sign / dv times z_1'
  kTangent2,                                                  ///< ... times z_2'
  kTangentRate1,                                              ///< ... times z_1''
  kTangentRate2,                                              ///< ... times z_2''
  kTangentV,                                                  ///< ... times v
  kProgressive,                                               ///< y sign v
  kProgressiveAbsolute,                                       ///< |y| sign v
  kSpeedSquared,                                              ///< v |v|
  kSpeed,                                                     ///< |v|
  kStribeck,                                                  ///< sign v exp(-|v| / v_s)
  kSquare = kStribeck + static_cast<int>(kStribeckSpeeds),    ///< y^2
  kCube,                                                      ///< y^3
  kMagnitude,                                                 ///< |y - kink|
  kBumpUp,                                                    ///< max(y - gap, 0)
  kBumpDown = kBumpUp + static_cast<int>(kBumpGaps),          ///< max(-y - gap, 0)
  kDahl = kBumpDown + static_cast<int>(kBumpGaps),            ///< Dahl's zeta
  kBacklash = kDahl + static_cast<int>(kDahlDistances),       ///< sign v once the gap is taken up
  kRelaxing = kBacklash + static_cast<int>(kBacklashGaps),    ///< stretch of a Maxwell spring
  kPitchSign = kRelaxing + static_cast<int>(kRelaxations),    ///< mean of both wheelsets' signs
  kModeBend = kPitchSign + static_cast<int>(kPitchModes),     ///< force of a mass on a spring
  kFrameRate = kModeBend + static_cast<int>(kFlexibleModes),  ///< z_b'''
  kFrameOnce,                                                 ///< z_b''' s^-2 : z_b'
  kFrameTwice,                                                ///< z_b
  kWheelset1Once,
  kWheelset1Twice,
  kWheelset2Once,
  kWheelset2Twice,
  kTarget,  ///< -z_b''
};
inline constexpr int kColumns = kTarget + 1;

/// Columns that are averaged over samples and projected by psi; the rest are linear in the
/// accelerations and projected by its integrals and derivative.
inline constexpr int kSampledColumns = kFrameRate;
/// Of these, functions of the motion; the others are filtered accelerations.
inline constexpr int kLawColumns = kModeBend;

}  // namespace dampline::effect
