// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

#include "dampline/result.hpp"
#include "published/oscillator/block_job.hpp"
#include "published/oscillator/block_memory.hpp"
#include "published/oscillator/window_schedule.hpp"

namespace dampline {

struct OscillatorIdentifierConfig {
  double sample_rate_hz{300.0};
  double clip_mps2{19.59};          ///< 12 bit, -+ 2 g: the last code and beyond is no measurement
  double least_velocity_mps{1e-3};  ///< blocks with a smaller rms are not used, nor rows across it
  Memory memory{Memory::kInfinite};
  double memory_blocks{0.0};  ///< length of the window, or time constant of forgetting
};

/// kInvalidConfig where a value is out of its range.
[[nodiscard]] inline Result<OscillatorIdentifierConfig> check(
    const OscillatorIdentifierConfig& config) noexcept {
  const bool remembers = config.memory == Memory::kInfinite || config.memory_blocks >= 4.0;
  if (!(config.sample_rate_hz >= 100.0 && config.sample_rate_hz <= 1000.0) ||
      !(config.clip_mps2 > 0.0) || !(config.least_velocity_mps > 0.0) || !remembers) {
    return Errc::kInvalidConfig;
  }
  return config;
}

/// An oscillator per unit mass from two accelerometers alone, one on the mass and one on its base:
///   a_mass + sum theta_i g_i(x, v) = 0,   x'' = a_mass - a_base,   v = x'.
/// After the block estimator of wavelet-Galerkin identification (Ghanem and Romeo 2001) for signals
/// that only exist as accelerations. Constant offsets of x are not observable: a stiffness is that
/// about the mean.
///
/// Blocks of `Block` samples, each seen with `Guard` samples to either side, so that the estimate
/// is Block + Guard samples old at most. At 300 Hz the defaults (4 s and 1 s) suit natural
/// frequencies of 2 to 6 Hz. Fixed memory; the work of a block is spread over the samples of the
/// next.
template <class Terms, int Block = 1200, int Guard = 300>
class OscillatorIdentifier {
  using Job = BlockJob<Terms, Block, Guard>;
  using Window = typename Job::Window;

 public:
  static constexpr int kTerms = Terms::kCount;
  static constexpr int kBlockSamples = Block;
  /// Samples of one window, with what the integrals need before and behind it.
  static constexpr int kWindowSamples = Window::kBefore + Window::kLength + Window::kAfter;
  using BlockStoreOfTerms = BlockMemory<kTerms + 1>;
  using Estimate = typename BlockStoreOfTerms::Estimate;

  /// `config` must have passed check().
  explicit OscillatorIdentifier(const OscillatorIdentifierConfig& config = {},
                                const Terms& terms = {}) noexcept
      : schedule_{{.before = Window::kBefore,
                   .length = Window::kLength,
                   .after = Window::kAfter,
                   .hop = Block,
                   .clip_mps2 = config.clip_mps2}},
        job_{terms, 1.0 / config.sample_rate_hz, config.least_velocity_mps},
        memory_{{.memory = config.memory, .memory_blocks = config.memory_blocks}} {}

  /// Takes one sample of both channels; `tick` counts the sensors' samples, and a jump in it is a
  /// gap. True when the information of one more block has been added.
  bool update(std::int64_t tick, double mass_mps2, double base_mps2) noexcept {
    if (const auto place = schedule_.place(tick, mass_mps2, base_mps2)) {
      ring_.set(*place, mass_mps2, base_mps2);
      if (const auto first = schedule_.complete()) job_.start(*first);
    }
    return advance();
  }

  /// Ends the work of the last whole window at once. True when a block has been added.
  bool finish() noexcept {
    bool added = false;
    for (int i = 0; i < Block; ++i) added = advance() || added;
    return added;
  }

  /// kNotReady below four blocks, and while the data do not determine every parameter.
  [[nodiscard]] Result<Estimate> estimate() const noexcept { return memory_.estimate(); }
  [[nodiscard]] const BlockStoreOfTerms& memory() const noexcept { return memory_; }
  [[nodiscard]] const ExcludedWindows& excluded() const noexcept { return schedule_.excluded(); }
  /// Adds what another run of the same settings has learned.
  void merge(const OscillatorIdentifier& other) noexcept { memory_.merge(other.memory_); }

 private:
  bool advance() noexcept {
    switch (job_.step(ring_)) {
      case BlockOutcome::kUsed:
        memory_.add(job_.factor(), job_.rows());
        return true;
      case BlockOutcome::kQuiet:
        ++schedule_.excluded().quiet;
        return false;
      case BlockOutcome::kUndetermined:
        ++schedule_.excluded().undetermined;
        return false;
      case BlockOutcome::kPending:
        return false;
    }
    return false;
  }

  WindowSchedule schedule_;
  typename Job::Ring ring_;
  Job job_;
  BlockStoreOfTerms memory_;
};

}  // namespace dampline
