// SPDX-License-Identifier: MIT
// What a person sets about a truck's stream; every field has a default that works but for the
// signals, which say where the accelerations stand in the frames.
#pragma once
#include <array>
#include <cstddef>

#include "dampline/basis/columns.hpp"
#include "dampline/estimate/block_store.hpp"
#include "dampline/guard/config.hpp"
#include "dampline/motion/anti_alias.hpp"
#include "dampline/sample/assembler.hpp"
#include "dampline/sample/channel.hpp"
#include "dampline/sample/screen.hpp"
#include "dampline/snapshot.hpp"

namespace dampline {

/// What turns samples into a curve. M z_b'' + k y + F(v) = 0 with y = 2 z_b - (z_1 + z_2), v = y'.
struct EstimatorConfig {
  double sample_rate_hz{300.0};    ///< 150...400
  double moving_mass_kg{37200.0};  ///< truck frame and its share of the body; scales every force
  /// J = I / a^2 of a frame that pitches: its inertia and half its wheelbase; of samples that have
  /// Extra::kFrameEnd. 0: they have not.
  double frame_pitch_mass_kg{0.0};
  /// M_other in M z_b'' + M_other z_far'' + k y + F = 0, the body's mass at the other truck's
  /// pivot, felt at this one; of samples that have Extra::kFarFrame. 0: they have not.
  double far_mass_kg{0.0};
  /// 0.7 or 1.0: what is slower is not velocity but drift. 0: chosen once, from the sensors' noise.
  double velocity_corner_hz{0.0};
  std::array<double, kCurveSegments> curve_nodes_mps{kDefaultCurveNodesMps};
  /// Of the sensors. What an Identifier hands on has been through a ReferenceLowPass.
  AntiAliasConfig anti_alias{};
  ScreenConfig screen{};  ///< its rate is taken from sample_rate_hz
  Memory memory{Memory::kInfinite};
  double memory_s{0.0};  ///< length of the window, or time constant
};

/// The whole way of a frame. The rate, the sensors' filter and their resolution are the
/// estimator's; those in `guard` are not used.
struct IdentifierConfig {
  EstimatorConfig estimator{};
  std::array<ChannelConfig, kChannels> signals{};  ///< by Channel; for push(CanFrame) alone
  /// For push(CanFrame) too: those that the estimator's masses ask for.
  ExtraSignals extra_signals{};
  GuardConfig guard{};  ///< what is declared about the data
  /// Samples wait so long for what the guards find, at most 10,000 of them; 0: they do not wait,
  /// faults are named all the same.
  double judgement_delay_s{24.0};
};

}  // namespace dampline
