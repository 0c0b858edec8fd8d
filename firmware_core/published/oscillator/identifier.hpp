// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <cstdint>
#include <optional>

#include "dampline/result.hpp"
#include "published/oscillator/block_job.hpp"
#include "published/oscillator/block_memory.hpp"

namespace dampline {

/// Windows that were not used, and why.
struct ExcludedWindows {
  std::int64_t clipped{0};
  std::int64_t not_finite{0};
  std::int64_t gaps{0};
  std::int64_t quiet{0};         ///< the motion was too small
  std::int64_t undetermined{0};  ///< too few rows after the gate
  [[nodiscard]] std::int64_t total() const noexcept {
    return clipped + not_finite + gaps + quiet + undetermined;
  }
};

/// Cuts a stream into windows of `length` good samples, one every `hop`. A lost, clipped or
/// non-finite sample ends the window that is being filled, and the next one starts behind it.
class WindowSchedule {
 public:
  struct Config {
    int before;  ///< samples needed before a window
    int length;
    int after;  ///< samples needed behind it
    int hop;
    double clip_mps2;  ///< a magnitude from here on is not a measurement
  };
  explicit WindowSchedule(const Config& config) noexcept : config_{config}, start_{config.before} {}

  /// The number under which to store this sample; none where it is not to be stored.
  std::optional<std::int64_t> place(std::int64_t tick, double mass_mps2,
                                    double base_mps2) noexcept {
    if (count_ > run_start_ && tick != last_tick_ + 1) cut(excluded_.gaps);
    last_tick_ = tick;
    if (!std::isfinite(mass_mps2) || !std::isfinite(base_mps2)) {
      cut(excluded_.not_finite);
      return std::nullopt;
    }
    if (std::abs(mass_mps2) >= config_.clip_mps2 || std::abs(base_mps2) >= config_.clip_mps2) {
      cut(excluded_.clipped);
      return std::nullopt;
    }
    return count_++;
  }

  /// The first sample of a window that the last stored sample has completed.
  std::optional<std::int64_t> complete() noexcept {
    if (count_ != start_ + config_.length + config_.after) return std::nullopt;
    const std::int64_t first = start_;
    start_ += config_.hop;
    return first;
  }

  [[nodiscard]] const ExcludedWindows& excluded() const noexcept { return excluded_; }
  [[nodiscard]] ExcludedWindows& excluded() noexcept { return excluded_; }

 private:
  void cut(std::int64_t& counter) noexcept {
    if (count_ > run_start_) ++counter;
    run_start_ = count_;
    start_ = count_ + config_.before;
  }

  Config config_;
  ExcludedWindows excluded_;
  std::int64_t count_{0};
  std::int64_t run_start_{0};
  std::int64_t start_;
  std::int64_t last_tick_{0};
};

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
