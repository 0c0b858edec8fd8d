// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dampline/sample.hpp"

namespace dampline {

/// What the guards found wrong with the data themselves, so that it is never taken for a property
/// of the suspension. Plain data; a list of faults has one entry for each kind and channel. How
/// each kind is found: the room guard/; what the names mean to a user: docs/faults.md; thresholds:
/// docs/constants.md.

/// What can be wrong with the data before they say anything about the suspension.
enum class FaultKind : std::uint8_t {
  kClipping,           ///< values end at a level: full scale or below it
  kStuckChannel,       ///< one value held while another channel moves
  kSpikes,             ///< single samples that no motion explains
  kDcJump,             ///< the zero of a channel moved at once
  kLostSamples,        ///< by counter, or by the delay between the wheelsets
  kRepeatedSamples,    ///< all channels once more
  kTimingStep,         ///< a channel is later or earlier from one moment on
  kClockDrift,         ///< a channel has a clock of its own
  kGainChange,         ///< the sensitivity of a sensor, as a step or slowly
  kSoftSaturation,     ///< a sensor that reads less the more there is
  kExcessNoise,        ///< more than declared
  kNoiseBurst,         ///< for some blocks only
  kResolutionLoss,     ///< the lowest bits do not move
  kSwappedChannels,    ///< frame and wheelset, or the two wheelsets
  kWrongPolarity,      ///< a sensor upside down
  kWrongSampleRate,    ///< rate, wheelbase or speed are not what was declared
  kIdenticalChannels,  ///< a channel shows what another one does, code for code
  kJitter,             ///< samples are taken at uneven times
  kRingingMount,       ///< what a sensor is mounted on has a resonance of its own
  kOffCentre,          ///< the frame's sensor sees the frame's pitch
  kForeignMotion,      ///< the frame does below its resonance what no wheelset does
  kWrongLowPass,       ///< the sensors' low pass is not what was declared
};
inline constexpr std::size_t kFaultKinds = 22;

/// Where a fault is. What compares the two wheelsets cannot tell which of them it is.
enum class FaultChannel : std::uint8_t { kFrame, kWheelset1, kWheelset2, kWheelsets, kAll };
inline constexpr std::size_t kFaultChannels = 5;
/// Of a list: half of the kinds are of one or two channels alone.
inline constexpr std::size_t kMostFaults = 90;

/// Everything known of one kind of fault in one channel. Times are of the record, from its first
/// tick at the nominal rate.
struct Fault {
  FaultKind kind{};
  FaultChannel channel{};
  double time_s{0.0};      ///< where it was first seen; where it began, if it has a beginning
  double size{0.0};        ///< in `unit`; of several events the largest, of samples their sum
  const char* unit{""};    ///< "m/s^2", "s", "samples", "%", "ppm", "Hz"
  std::uint64_t count{0};  ///< events; blocks of 10 s where it has no events
  double last_s{0.0};      ///< where it was last seen
};

/// The name that reports and files use.
[[nodiscard]] constexpr const char* name_of(FaultKind kind) noexcept {
  constexpr std::array<const char*, kFaultKinds> kNames{
      "clipping",           "stuck_channel",    "spikes",         "dc_jump",
      "lost_samples",       "repeated_samples", "timing_step",    "clock_drift",
      "gain_change",        "soft_saturation",  "excess_noise",   "noise_burst",
      "resolution_loss",    "swapped_channels", "wrong_polarity", "wrong_sample_rate",
      "identical_channels", "jitter",           "ringing_mount",  "off_centre",
      "foreign_motion",     "wrong_low_pass"};
  return kNames[static_cast<std::size_t>(kind)];
}

/// The unit of Fault::size; "-" and "ratio" have none.
[[nodiscard]] constexpr const char* unit_of(FaultKind kind) noexcept {
  constexpr std::array<const char*, kFaultKinds> kUnits{
      "m/s^2", "s",     "m/s^2", "m/s^2", "samples", "samples", "s", "ppm", "%", "%", "m/s^2",
      "m/s^2", "m/s^2", "ratio", "-",     "Hz",      "-",       "s", "Hz",  "%", "%", "Hz"};
  return kUnits[static_cast<std::size_t>(kind)];
}

[[nodiscard]] constexpr const char* name_of(FaultChannel channel) noexcept {
  constexpr std::array<const char*, kFaultChannels> kNames{"frame", "wheelset1", "wheelset2",
                                                           "wheelsets", "all"};
  return kNames[static_cast<std::size_t>(channel)];
}

/// The place of one channel, indexed as Sample::accel_mps2 is.
[[nodiscard]] constexpr FaultChannel channel_of(std::size_t channel) noexcept {
  return static_cast<FaultChannel>(channel);
}

/// What was found and belongs to the car's ride, not to the faults. Monotone.
struct GuardInputs {
  std::array<std::uint64_t, 3> impacts{};  ///< by channel: rail joints, wheel flats
  std::uint64_t speed_changes{0};
};

/// What was put in where single values were missing.
struct BridgeFigures {
  std::uint64_t values{0};
  double share{0.0};                           ///< of the samples: those with such a value
  std::array<double, kChannels> error_mps2{};  ///< of a value, rms, as the prediction states it
  std::array<double, kChannels> noise_mps2{};  ///< that they make of all samples, rms
};

/// Channels whose samples were put at the times of their own stamps.
struct PlacedFigures {
  std::array<double, kChannels> off_s{};  ///< what they were off even times, rms; 0: none was
};

/// What was done about faults that passed. Monotone.
struct RepairCounts {
  std::uint64_t replaced{0};  ///< values of a channel, by what their neighbours say
  std::uint64_t spoilt{0};    ///< samples that were left out
  BridgeFigures bridged;
  PlacedFigures placed;
};

/// How much more the frame moves with the wheelsets below the suspension's resonance than it did
/// before, relative: there its sensor's gain shows, and its mass hardly does.
struct FrameFollow {
  double usual{0.0};  ///< 1.05 to 1.3 in a sound truck; 0: not known yet
  double step{0.0};
  double step_significance{0.0};  ///< in deviations
  double trend{0.0};              ///< over the newest blocks, ten minutes of them at most
  double trend_significance{0.0};
};

/// How the sensors sit, as the motion itself tells: see PlaceWatch. 0: not known yet.
struct Misplacement {
  double foreign_share{0.0};  ///< of the frame's power at 1.2 Hz: neither of wheelsets nor noise
  /// Of half the wheelsets' difference, that the frame shows at 3.5 to 7.6 Hz; and how much that is
  /// of what the wheelsets' mean leaves of the frame's power there.
  double difference{0.0};
  double difference_share{0.0};
  double gain{0.0};  ///< of wheelset 1 over wheelset 2, by their power there; less 1
};

/// The faults at one moment, times in seconds by the nominal rate. Plain: it can be handed between
/// threads; some 4 KiB.
struct FaultView {
  std::array<Fault, kMostFaults> faults{};
  std::size_t count{0};
  GuardInputs inputs;
  RepairCounts repairs;
  FrameFollow frame_follow;
  Misplacement misplacement;
  [[nodiscard]] std::span<const Fault> list() const noexcept { return {faults.data(), count}; }
};

/// What may change while the record is made.
enum class DriftingParameter : std::uint8_t { kFriction, kStiffness, kMass };

/// As parameters.json calls it.
[[nodiscard]] constexpr const char* name_of(DriftingParameter parameter) noexcept {
  switch (parameter) {
    case DriftingParameter::kFriction:
      return "coulomb";
    case DriftingParameter::kStiffness:
      return "stiffness";
    case DriftingParameter::kMass:
      break;
  }
  return "moving_mass";
}

/// The newest alarms: a parameter is not what it was when the watch began. Plain.
struct AlarmView {
  static constexpr std::size_t kMost = 8;
  struct Alarm {
    DriftingParameter parameter{};
    double change{0.0};          ///< relative: -0.3 means 30 % less than before
    std::int64_t since_tick{0};  ///< the first block that had changed
    std::int64_t tick{0};        ///< when it was noticed
  };
  std::array<Alarm, kMost> alarms{};  ///< ring: alarm i lies at i % kMost
  std::uint64_t count{0};             ///< ever
};

}  // namespace dampline
