// SPDX-License-Identifier: MIT
// What the Guard judges at the end of a block; the path of a sample is in guard.cpp.
#include <algorithm>
#include <cmath>

#include "dampline/guard/guard.hpp"

namespace dampline {
namespace {

constexpr double kFewSpikes = 3.0;
constexpr double kShareOfImpacts = 2.0;
constexpr double kTallyKept = 0.98;  // a block
constexpr double kWrongRate = 0.003;
constexpr int kRateBlocks = 3;

}  // namespace

// What was counted in other codes is forgotten.
void Guard::use_learned_steps() noexcept {
  knows_steps_ = true;
  for (std::size_t c = 0; c < kChannels; ++c) {
    if (config_.step_mps2[c] > 0.0) continue;
    knows_steps_ = knows_steps_ && steps_[c].step() > 0.0;
    unit_mps2_[c] = std::max(steps_[c].step(), kUnknownStepMps2);
    codes_[c] = CodeWatch{};
    spikes_[c] = SpikeWatch{ticks_of(2.0)};
    runs_[c] = {};
  }
  repeats_.restart();
}

// Where many strikes are impacts, some of them are as narrow as a wrong sample.
void Guard::judge_spikes(std::size_t channel) noexcept {
  SpikeTally& tally = spike_tally_[channel];
  const bool mostly_impacts = tally.wrong < kShareOfImpacts * tally.impacts;
  if (mostly_impacts || rhythm_[channel].regular()) {
    inputs_.impacts[channel] += tally.count;
    tally.count = 0;
  } else if (tally.wrong >= kFewSpikes) {
    for (std::size_t i = 0; i < tally.count; ++i) {
      const Strike& strike = tally.pending[i];
      log_.report(FaultKind::kSpikes, channel_of(channel), log_.seconds(strike.tick),
                  static_cast<double>(strike.height) * unit(channel));
    }
    tally.count = 0;
  }
  tally.impacts *= kTallyKept;
  if (tally.wrong >= kFewSpikes) tally.wrong = std::max(tally.wrong * kTallyKept, kFewSpikes);
}

void Guard::take_code_verdict(std::size_t channel, std::int64_t tick) noexcept {
  const CodeVerdict verdict = codes_[channel].close();
  const double began_s = log_.seconds(block_start_);
  if (verdict.dead_bits > 0 && config_.step_mps2[channel] > 0.0) {
    log_.report(FaultKind::kResolutionLoss, channel_of(channel), began_s,
                std::ldexp(unit(channel), verdict.dead_bits));
    log_.spoil(FaultKind::kResolutionLoss, channel_of(channel), block_start_, tick);
  }
  if (verdict.clips) {
    log_.report(FaultKind::kClipping, channel_of(channel), log_.seconds(verdict.clip_first),
                std::abs(static_cast<double>(verdict.clip_code)) * unit(channel),
                static_cast<std::uint64_t>(verdict.clip_count));
    log_.spoil(FaultKind::kClipping, channel_of(channel), block_start_, tick);
  }
}

void Guard::close_block(std::int64_t tick) noexcept {
  if (!knows_steps_) use_learned_steps();
  for (std::size_t c = 0; c < kChannels; ++c) {
    take_code_verdict(c, tick);
    judge_spikes(c);
    spectral_.set_impulse_power(c, impulses_[c].take());
  }
  repeats_.forget();
  const bool whole = tick - block_start_ >= block_ticks_;
  const bool sound = whole && spectral_.steady() && log_.spoilt(block_start_, tick) == 0;
  wheelsets_.close_block(sound, tick, log_);
  spectral_.set_difference(wheelsets_.difference_mps2());
  if (spectral_.has_delay()) wheelsets_.set_delay(spectral_.delay_s());
  judge_time(last_);
  block_start_ = tick;
  block_start_ns_ = last_.time_ns;
}

// Time that the samples carry against the rate that was declared.
void Guard::judge_time(const Sample& sample) noexcept {
  const double seconds = 1e-9 * static_cast<double>(sample.time_ns - block_start_ns_);
  if (!(seconds > 0.0)) return;
  const double rate_hz = static_cast<double>(sample.tick - block_start_) / seconds;
  const bool wrong = std::abs(rate_hz / config_.sample_rate_hz - 1.0) > kWrongRate;
  wrong_rate_blocks_ = wrong ? wrong_rate_blocks_ + 1 : 0;
  if (wrong_rate_blocks_ < kRateBlocks) return;
  log_.report(FaultKind::kWrongSampleRate, FaultChannel::kAll, log_.seconds(block_start_), rate_hz);
}

void Guard::finish() noexcept {
  if (any_ && last_.tick > block_start_) close_block(last_.tick);
}

}  // namespace dampline
