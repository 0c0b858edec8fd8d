// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/motion/anti_alias.hpp"
#include "dampline/sample.hpp"

namespace dampline {

/// Brings the samples of all sensors behind one low pass: a Butterworth of fourth order at 100 Hz,
/// where level and stiffness were calibrated, or the sensors' lowest where that lies lower. Its
/// response over the sensor's own is a filter of 14 taps, by least squares up to 0.42 of the rate,
/// with two samples of delay for all channels. Its phase is wanted as much as its gain: friction's
/// kinks and a filter's delay bias stiffness against one another
/// (docs/adr/0021-reference-low-pass.md).
/// Samples of sensors that are all behind one lower filter, or an unknown one, go through as they
/// are.
class ReferenceLowPass {
 public:
  /// What the estimate sees of samples behind `sensors`: one filter for all channels.
  [[nodiscard]] static AntiAliasConfig seen_behind(const AntiAliasConfig& sensors) noexcept;

  ReferenceLowPass(const AntiAliasConfig& sensors, double sample_rate_hz) noexcept;
  /// The same sample with its accelerations filtered, until the next call. A gap, a sample that is
  /// no number or one that is spoilt starts anew, from a state of rest at the next sample's values.
  [[nodiscard]] const Sample& update(const Sample& sample) noexcept {
    return is_needed_ ? filtered(sample) : sample;
  }

 private:
  static constexpr std::size_t kTaps = 14;
  static constexpr std::size_t kSignals = kChannels + kExtras;
  using Signals = std::array<double, kSignals>;
  using Taps = std::array<Signals, kTaps>;  // of the newest sample first

  /// What makes of samples behind `sensor` such behind `reference`.
  [[nodiscard]] static std::array<double, kTaps> taps_between(const AntiAliasConfig& sensor,
                                                              const AntiAliasConfig& reference,
                                                              double sample_rate_hz) noexcept;
  [[nodiscard]] const Sample& filtered(const Sample& sample) noexcept;

  bool is_needed_{false};
  Taps taps_{};
  std::array<Signals, kTaps> held_{};
  std::size_t newest_{0};
  std::int64_t last_tick_{0};
  bool any_{false};
  Sample out_{};
};

}  // namespace dampline
