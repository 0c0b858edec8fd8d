// SPDX-License-Identifier: MIT
// The corridor with four sets of parts, fed by the project's own sensors.
#pragma once
#include <array>

#include "app/record/frames.hpp"
#include "dampline/identifier.hpp"

namespace dampline::bench {

/// Decode, checks, motion, wavelet rows, estimate.
inline constexpr Parts kFramesToEstimate{
    .guards = false, .densities = false, .phase = false, .alarms = false};
/// And the densities.
inline constexpr Parts kFramesToDensities{.guards = false, .phase = false, .alarms = false};

/// The project's own sensors.
inline AssemblerConfig frame_config() { return app::can_channels(app::Config{}); }

inline IdentifierConfig chain_config() {
  IdentifierConfig config;
  config.signals = frame_config().channels;
  config.estimator.screen = app::screen_of(config.signals);
  config.estimator.screen.sample_rate_hz = config.estimator.sample_rate_hz;
  return config;
}

/// Frames of one truck to what is known, one thread. Place it on the heap.
template <Parts kParts>
struct Chain : BasicIdentifier<kParts> {
  using Base = BasicIdentifier<kParts>;
  Chain() : Base{chain_config()} {}
  using Base::push;
  /// The frames of one sampling instant.
  void push(const std::array<CanFrame, kChannels>& frames) noexcept {
    for (const CanFrame& frame : frames) Base::push(frame);
  }
};

}  // namespace dampline::bench
