// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "dampline/guard/channel_watch.hpp"
#include "dampline/guard/config.hpp"
#include "dampline/guard/fault_log.hpp"
#include "dampline/guard/spectral_guard.hpp"
#include "dampline/guard/spike_watch.hpp"
#include "dampline/guard/wheelset_watch.hpp"
#include "dampline/result.hpp"
#include "dampline/sample.hpp"

namespace dampline {

/// One value of one channel that no motion explains.
struct WrongSample {
  std::int64_t tick{0};
  std::size_t channel{0};
};

/// Companion of the Estimator: names what is wrong with the data themselves, so that it is never
/// taken for a property of the suspension. The same samples in, in any order of the two; faults at
/// any moment. Fixed size, bounded work per sample, no second pass. What needs blocks is known some
/// 10 to 40 s after it happened.
///
/// Tests and thresholds are those of a study on 927 simulated records of three cars; whatever may
/// differ between cars is measured against the record's own scatter.
class Guard {
 public:
  static constexpr double kBlockS = 10.0;  ///< about; of the tests that judge codes exactly

  /// kInvalidConfig when a setting is out of its range.
  [[nodiscard]] static Result<GuardConfig> check(const GuardConfig& config) noexcept;
  /// Precondition: check(config).ok().
  explicit Guard(const GuardConfig& config) noexcept;

  /// Ticks must increase; a sample that does not is ignored.
  void update(const Sample& sample) noexcept { update(sample, sample.accel_mps2); }
  /// The same of a sample that was put at an even time; `taken_mps2`: as its sensors sent it, by
  /// whose codes some faults are told.
  void update(const Sample& sample, const std::array<double, kChannels>& taken_mps2) noexcept;
  /// What was put in so far where values were missing: no noise of a sensor.
  void set_bridged(const BridgeFigures& figures) noexcept { spectral_.set_bridged(figures); }
  /// End of the record: judges what is left of the open block.
  void finish() noexcept;

  /// One entry for each kind and channel, in the order in which they were found.
  [[nodiscard]] std::span<const Fault> faults() const noexcept { return log_.faults(); }
  /// Bit k set: fault kind k makes samples of these ticks useless; both ends included. Final when
  /// the newest sample is 12 s later; of noise bursts 60 s.
  [[nodiscard]] std::uint32_t spoilt(std::int64_t first_tick,
                                     std::int64_t last_tick) const noexcept {
    return log_.spoilt(first_tick, last_tick);
  }
  [[nodiscard]] bool spoilt(FaultKind kind, FaultChannel channel,
                            std::int64_t tick) const noexcept {
    return log_.spoilt(kind, channel, tick);
  }
  /// Single wrong samples, each reported once and some 2 s after it was taken; false when there is
  /// no more. Of those that nobody asks for in time the newest 16 stay.
  [[nodiscard]] bool next_wrong_sample(WrongSample& out) noexcept;
  /// Impacts and changes of speed: input, not faults.
  [[nodiscard]] const GuardInputs& inputs() const noexcept { return inputs_; }
  /// Of the newest block of spectra that was judged.
  [[nodiscard]] const BlockFigures& block() const noexcept { return spectral_.figures(); }
  [[nodiscard]] FrameFollow frame_follow() const noexcept { return spectral_.frame_follow(); }
  [[nodiscard]] Misplacement misplacement() const noexcept { return spectral_.misplacement(); }
  /// White noise of a channel, rms, what its resolution makes included; 0: not known yet.
  [[nodiscard]] double noise_mps2(std::size_t channel) const noexcept {
    return spectral_.noise_mps2(channel);
  }

 private:
  static constexpr std::int64_t kBridged = 8;  // missing samples that a line is drawn across
  struct Run {
    std::int64_t code{0};
    std::int64_t first_tick{0};
    std::int64_t before{0};              // the code that it followed
    std::int64_t lowest{0}, highest{0};  // of the other channels during the run
    bool reported{false};
  };
  static constexpr std::size_t kPending = 32;
  struct Spike {
    std::int64_t tick{0};
    double height_mps2{0.0};  // codes may get another unit before it is told
  };
  struct SpikeTally {
    std::array<Spike, kPending> pending{};  // of the open block and the ones before three are there
    std::size_t count{0};
    double wrong{0.0};  // all so far, what is long ago counts less
    double impacts{0.0};
  };
  using Codes = std::array<std::int64_t, kChannels>;
  /// A jump of a channel's zero, until it is known whether the others have it too.
  struct HeldJump {
    LevelJump jump{};
    std::int64_t found_tick{0};
    bool waits{false};
  };

  /// How often a loose contact opened, all with this code; what is long ago counts less.
  struct Contacts {
    std::int64_t code{0};
    double count{0.0};
  };
  /// Samples of a block in which a pair of channels moved, and of these: both alike.
  struct Twins {
    std::int64_t moved{0};
    std::int64_t alike{0};
  };

  void take_gap(const Sample& sample) noexcept;
  void restart() noexcept;
  void watch_codes(const Sample& sample, const Codes& codes) noexcept;
  void watch_runs(const Sample& sample, const Codes& codes) noexcept;
  void watch_contact(std::size_t channel, std::int64_t code) noexcept;
  void take_repeat(std::int64_t tick) noexcept;
  void take_jump(std::size_t channel, const LevelJump& jump, std::int64_t tick) noexcept;
  void settle_jumps(std::int64_t tick) noexcept;
  void report_jump(std::size_t channel) noexcept;
  void watch_full_scale(const Sample& sample) noexcept;
  void watch_twins(const Codes& codes) noexcept;
  void judge_twins() noexcept;
  void take_strikes() noexcept;
  void judge_spikes(std::size_t channel) noexcept;
  void close_block(std::int64_t tick) noexcept;
  void judge_time(const Sample& sample) noexcept;
  void use_learned_steps() noexcept;
  void take_code_verdict(std::size_t channel, std::int64_t tick) noexcept;
  [[nodiscard]] double unit(std::size_t channel) const noexcept { return unit_mps2_[channel]; }

  static constexpr double kUnknownStepMps2 = 1e-4;  // least unit of a code that nobody declared
  [[nodiscard]] std::int64_t ticks_of(double seconds) const noexcept {
    return std::llround(seconds * config_.sample_rate_hz);
  }

  GuardConfig config_;
  std::array<double, kChannels> unit_mps2_{};  // of a code
  std::array<StepMeter, kChannels> steps_{};
  bool knows_steps_{false};
  std::int64_t block_ticks_;
  std::int64_t stuck_ticks_;
  FaultLog log_;
  GuardInputs inputs_{};
  std::array<CodeWatch, kChannels> codes_{};
  std::array<SpikeWatch, kChannels> spikes_;
  std::array<LevelWatch, kChannels> levels_;
  std::array<HeldJump, kChannels> jumps_{};
  bool jumps_wait_{false};
  std::array<ImpulsePower, kChannels> impulses_{};
  RepeatWatch repeats_;
  SpectralGuard spectral_;
  WheelsetWatch wheelsets_;
  std::array<Run, kChannels> runs_{};
  std::array<Contacts, kChannels> contacts_{};
  std::array<Twins, kChannels> twins_{};  // channel c and the one after it
  Codes last_codes_{};
  std::array<std::uint64_t, kChannels> saturated_{};
  std::array<std::int64_t, kChannels> first_saturated_{};
  std::array<SpikeTally, kChannels> spike_tally_{};
  std::array<Regularity, kChannels> rhythm_{};
  std::array<WrongSample, 16> wrong_{};
  std::size_t wrong_pushed_{0};
  std::size_t wrong_popped_{0};
  bool any_{false};
  std::int64_t no_numbers_{0};  // samples since the last one that came with a value
  Sample last_{};
  std::int64_t block_start_{0};
  std::int64_t block_start_ns_{0};
  int wrong_rate_blocks_{0};
  std::int64_t wrong_rate_from_{0};  // where the first of them began
  std::int64_t wrong_rate_from_ns_{0};
};

}  // namespace dampline
