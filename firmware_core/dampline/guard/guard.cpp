// SPDX-License-Identifier: MIT
#include "dampline/guard/guard.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "dampline/sample/screen.hpp"
#include "dampline/sample/ticks.hpp"

namespace dampline {
namespace {

constexpr std::uint64_t kFewSaturated = 3;
// A channel that is stuck or clips has no level of its own.
constexpr std::uint32_t kNoLevel = 1U << static_cast<unsigned>(FaultKind::kStuckChannel) |
                                   1U << static_cast<unsigned>(FaultKind::kClipping);
constexpr double kMostRateHz = 2000.0;

bool positive_or_unknown(double x) noexcept { return x >= 0.0 && std::isfinite(x); }

constexpr double kJumpsTogetherS = 3.0;
constexpr double kJumpsAlike = 0.25;  // of the largest
constexpr double kJumpsAlikeMps2 = 0.1;
constexpr double kFewSpikes = 3.0;
constexpr double kShareOfImpacts = 2.0;
constexpr std::int64_t kLeastHeld = 4;  // samples
constexpr std::int64_t kLongHeld = 6;
constexpr double kLeap = 3.0;  // deviations of the second difference
constexpr double kLeapOfLong = 0.3;
constexpr double kLeapCodes = 6.0;  // that the channel resolves
constexpr double kFewContacts = 2.5;
constexpr double kTallyKept = 0.98;  // a block
constexpr double kWrongRate = 0.003;
constexpr int kRateBlocks = 3;
constexpr double kTwins = 0.9;  // clean wheelsets agree in at most 0.03 of the samples

struct SpanOfTime {
  double samples;
  double seconds;
  [[nodiscard]] double rate_hz() const noexcept { return samples / seconds; }
};

}  // namespace

Result<GuardConfig> Guard::check(const GuardConfig& config) noexcept {
  if (!(config.sample_rate_hz >= 50.0 && config.sample_rate_hz <= kMostRateHz)) {
    return Errc::kInvalidConfig;
  }
  for (std::size_t c = 0; c < kChannels; ++c) {
    if (!positive_or_unknown(config.step_mps2[c])) return Errc::kInvalidConfig;
    if (!positive_or_unknown(config.noise_mps2[c])) return Errc::kInvalidConfig;
  }
  if (!positive_or_unknown(config.wheelbase_m)) return Errc::kInvalidConfig;
  if (!positive_or_unknown(config.speed_mps)) return Errc::kInvalidConfig;
  if (!config.anti_alias.is_usable()) return Errc::kInvalidConfig;
  return config;
}

Guard::Guard(const GuardConfig& config) noexcept
    : config_{config},
      block_ticks_{ticks_of(kBlockS)},
      stuck_ticks_{std::llround(stuck_samples(config.sample_rate_hz))},
      log_{config.sample_rate_hz},
      spikes_{SpikeWatch{ticks_of(2.0)}, SpikeWatch{ticks_of(2.0)}, SpikeWatch{ticks_of(2.0)}},
      levels_{LevelWatch{ticks_of(1.0)}, LevelWatch{ticks_of(1.0)}, LevelWatch{ticks_of(1.0)}},
      repeats_{ticks_of(2.5)},
      spectral_{config},
      wheelsets_{config.sample_rate_hz} {
  for (std::size_t c = 0; c < kChannels; ++c) {
    unit_mps2_[c] = config.step_mps2[c] > 0.0 ? config.step_mps2[c] : kUnknownStepMps2;
  }
}

void Guard::update(const Sample& sample, const std::array<double, kChannels>& taken_mps2) noexcept {
  if (any_ && sample.tick <= last_.tick) return;
  Codes codes{};
  for (std::size_t c = 0; c < kChannels; ++c) {
    if (!is_number(sample.accel_mps2[c])) {  // the screen's, not ours
      ++no_numbers_;
      return;
    }
    if (!knows_steps_ && !is_bridged(sample, c)) steps_[c].update(taken_mps2[c]);
    codes[c] = std::llround(taken_mps2[c] / unit(c));
  }
  if (!any_) {
    block_start_ = sample.tick;
    block_start_ns_ = sample.time_ns;
  } else if (sample.tick != last_.tick + 1) {
    take_gap(sample);
  }
  if (sample.lost)
    log_.report(FaultKind::kLostSamples, FaultChannel::kAll, log_.seconds(sample.tick), 1.0);
  if (sample.bridged != 0) wheelsets_.strike(sample.tick);
  watch_codes(sample, codes);
  spectral_.push(sample.tick, sample.accel_mps2, false);
  for (std::size_t c = 0; c < kChannels; ++c) {
    spectral_.set_change_scale(c, spikes_[c].scale() * unit(c));
  }
  spectral_.advance(log_, inputs_);
  if (!spectral_.knows_delay() || wheelsets_.differs_from(spectral_.delay_s())) wheelsets_.doubt();
  wheelsets_.update(sample.tick, sample.accel_mps2[1], sample.accel_mps2[2], log_);
  spectral_.set_jump(wheelsets_.jump_tick());
  take_strikes();
  any_ = true;
  last_ = sample;
  if (sample.tick - block_start_ >= block_ticks_) close_block(sample.tick);
}

bool Guard::next_wrong_sample(WrongSample& out) noexcept {
  if (wrong_pushed_ - wrong_popped_ > wrong_.size()) wrong_popped_ = wrong_pushed_ - wrong_.size();
  if (wrong_popped_ == wrong_pushed_) return false;
  out = wrong_[wrong_popped_++ % wrong_.size()];
  return true;
}

// A few missing samples are bridged, so that what lives on delays goes on.
void Guard::take_gap(const Sample& sample) noexcept {
  const std::int64_t missing = sample.tick - last_.tick - 1;
  const std::int64_t lost = missing - std::min(no_numbers_, missing);
  no_numbers_ = 0;
  if (lost > 0) {
    log_.report(FaultKind::kLostSamples, FaultChannel::kAll, log_.seconds(last_.tick + 1),
                static_cast<double>(lost));
    log_.spoil_by_gap(last_.tick, sample.tick);
  }
  if (missing > kBridged) return restart();
  for (SpikeWatch& watch : spikes_) watch.restart();
  for (ImpulsePower& impulses : impulses_) impulses.restart();
  repeats_.restart();
  const auto length = static_cast<double>(missing + 1);
  for (std::int64_t i = 1; i <= missing; ++i) {
    const double u = static_cast<double>(i) / length;
    std::array<double, kChannels> between{};
    for (std::size_t c = 0; c < kChannels; ++c) {
      between[c] = (1.0 - u) * last_.accel_mps2[c] + u * sample.accel_mps2[c];
    }
    spectral_.push(last_.tick + i, between, true);
    wheelsets_.update(last_.tick + i, between[1], between[2], log_);
  }
  wheelsets_.strike(sample.tick);
}

void Guard::restart() noexcept {
  for (SpikeWatch& watch : spikes_) watch.restart();
  for (ImpulsePower& impulses : impulses_) impulses.restart();
  for (LevelWatch& watch : levels_) watch.restart();
  repeats_.restart();
  spectral_.restart();
  wheelsets_.restart();
  runs_ = {};
}

void Guard::watch_codes(const Sample& sample, const Codes& codes) noexcept {
  watch_full_scale(sample);
  watch_runs(sample, codes);
  watch_twins(codes);
  if (repeats_.update(sample.tick, codes)) take_repeat(sample.tick);
  for (std::size_t c = 0; c < kChannels; ++c) {
    if (!is_bridged(sample, c)) codes_[c].update(sample.tick, codes[c]);
    spikes_[c].update(sample.tick, codes[c]);
    impulses_[c].update(sample.accel_mps2[c]);
    if (LevelJump jump; levels_[c].update(sample.tick, sample.accel_mps2[c], jump))
      take_jump(c, jump, sample.tick);
  }
  if (jumps_wait_) settle_jumps(sample.tick);
}

// The wheelsets are out of step until the wheelset behind has repeated it, too.
void Guard::take_repeat(std::int64_t tick) noexcept {
  if (!repeats_.found()) return;
  const std::int64_t first = repeats_.first_tick();
  log_.report(FaultKind::kRepeatedSamples, FaultChannel::kAll, log_.seconds(first),
              repeats_.excess());
  const auto delay =
      static_cast<std::int64_t>(std::abs(spectral_.delay_s()) * config_.sample_rate_hz);
  if (tick - first < block_ticks_)
    log_.spoil(FaultKind::kRepeatedSamples, FaultChannel::kAll, first, tick + delay);
  wheelsets_.strike(tick);
  repeats_.clear();
}

void Guard::take_jump(std::size_t channel, const LevelJump& jump, std::int64_t tick) noexcept {
  if ((log_.spoilt(jump.tick - block_ticks_ / 2, jump.tick + block_ticks_ / 2) & kNoLevel) != 0)
    return;
  if (jumps_[channel].waits) report_jump(channel);
  jumps_[channel] = {jump, tick, true};
  jumps_wait_ = true;
}

// The cant of a curve moves the zero of all channels alike: it belongs to the ride.
void Guard::settle_jumps(std::int64_t tick) noexcept {
  const bool due = std::any_of(jumps_.begin(), jumps_.end(), [&](const HeldJump& held) {
    return held.waits && tick - held.found_tick >= ticks_of(kJumpsTogetherS);
  });
  if (!due) return;
  const auto size = [](const HeldJump& held) { return held.jump.size_mps2; };
  const auto [least, most] =
      std::minmax_element(jumps_.begin(), jumps_.end(),
                          [&](const HeldJump& a, const HeldJump& b) { return size(a) < size(b); });
  const bool all = std::all_of(jumps_.begin(), jumps_.end(), [](auto& held) { return held.waits; });
  const double largest = std::max(std::abs(size(*least)), std::abs(size(*most)));
  const bool alike =
      all && size(*most) - size(*least) < std::max(kJumpsAlike * largest, kJumpsAlikeMps2);
  for (std::size_t c = 0; c < kChannels; ++c) {
    if (jumps_[c].waits && !alike) report_jump(c);
    jumps_[c].waits = false;
  }
  jumps_wait_ = false;
}

void Guard::report_jump(std::size_t channel) noexcept {
  const LevelJump& jump = jumps_[channel].jump;
  log_.report(FaultKind::kDcJump, channel_of(channel), log_.seconds(jump.tick), jump.size_mps2);
  log_.spoil(FaultKind::kDcJump, channel_of(channel), jump.tick - block_ticks_ / 10,
             jump.tick + block_ticks_ / 10);
}

void Guard::watch_full_scale(const Sample& sample) noexcept {
  for (std::size_t c = 0; c < kChannels; ++c) {
    if ((sample.saturated >> c & 1U) == 0) continue;
    if (saturated_[c]++ == 0) first_saturated_[c] = sample.tick;
    log_.spoil(FaultKind::kClipping, channel_of(c), sample.tick, sample.tick);
    if (saturated_[c] < kFewSaturated) continue;
    const bool first = saturated_[c] == kFewSaturated;
    log_.report(FaultKind::kClipping, channel_of(c),
                log_.seconds(first ? first_saturated_[c] : sample.tick),
                std::abs(sample.accel_mps2[c]), first ? kFewSaturated : 1);
  }
}

void Guard::watch_runs(const Sample& sample, const Codes& codes) noexcept {
  for (std::size_t c = 0; c < kChannels; ++c) {
    if (is_bridged(sample, c)) continue;
    Run& run = runs_[c];
    const std::int64_t other = codes[(c + 1) % kChannels];
    const std::int64_t another = codes[(c + 2) % kChannels];
    const std::int64_t sum = other + another;
    if (run.first_tick == 0 || codes[c] != run.code) {
      if (last_.tick - run.first_tick + 1 >= kLeastHeld) watch_contact(c, codes[c]);
      if (run.reported) {
        log_.report(FaultKind::kStuckChannel, channel_of(c), log_.seconds(last_.tick),
                    log_.seconds(last_.tick - run.first_tick + 1), 0);
      }
      run = {.code = codes[c],
             .first_tick = sample.tick,
             .before = run.code,
             .lowest = sum,
             .highest = sum};
      continue;
    }
    run.lowest = std::min(run.lowest, sum);
    run.highest = std::max(run.highest, sum);
    const bool stuck =
        sample.tick - run.first_tick + 1 >= stuck_ticks_ && run.highest - run.lowest > kStepsMoved;
    if (!stuck) continue;
    log_.spoil(FaultKind::kStuckChannel, channel_of(c), run.reported ? sample.tick : run.first_tick,
               sample.tick);
    if (run.reported) continue;
    run.reported = true;
    log_.report(FaultKind::kStuckChannel, channel_of(c), log_.seconds(run.first_tick),
                log_.seconds(stuck_ticks_));
  }
}

// A loose contact: the channel leaps to a code, holds it for some samples and leaps back, while
// the others move, and time and again it is the same code. No motion does that; what clips holds a
// code at an end of its range.
void Guard::watch_contact(std::size_t channel, std::int64_t code) noexcept {
  const Run& run = runs_[channel];
  const std::int64_t held = last_.tick - run.first_tick + 1;
  const bool others_moved = run.highest - run.lowest > kStepsMoved;
  if (run.reported || !others_moved || codes_[channel].is_extreme(run.code)) return;
  const double resolution = std::ldexp(1.0, codes_[channel].dead_bits());
  const double leap = (held < kLongHeld ? kLeap : kLeapOfLong) * spikes_[channel].scale();
  const std::int64_t least = std::min(std::abs(run.code - run.before), std::abs(code - run.code));
  if (static_cast<double>(least) < std::max(leap, kLeapCodes * resolution)) return;
  Contacts& contacts = contacts_[channel];
  if (run.code != std::exchange(contacts.code, run.code)) contacts.count = 0.0;
  contacts.count += 1.0;
  log_.spoil(FaultKind::kStuckChannel, channel_of(channel), run.first_tick, last_.tick);
  if (contacts.count < kFewContacts) return;
  log_.report(FaultKind::kStuckChannel, channel_of(channel), log_.seconds(run.first_tick),
              log_.seconds(held));
}

// Two sensors never agree in every code while they move: one of them is the other's copy.
void Guard::watch_twins(const Codes& codes) noexcept {
  for (std::size_t c = 0; c < kChannels; ++c) {
    const std::size_t next = (c + 1) % kChannels;
    if (codes[c] == last_codes_[c]) continue;
    ++twins_[c].moved;
    if (codes[c] == codes[next]) ++twins_[c].alike;
  }
  last_codes_ = codes;
}

void Guard::judge_twins() noexcept {
  for (std::size_t c = 0; c < kChannels; ++c) {
    const Twins seen = std::exchange(twins_[c], {});
    if (seen.moved < block_ticks_ / 10 ||
        static_cast<double>(seen.alike) < kTwins * static_cast<double>(seen.moved))
      continue;
    log_.report(FaultKind::kIdenticalChannels,
                c == 1 ? FaultChannel::kWheelsets : FaultChannel::kAll, log_.seconds(block_start_),
                1.0);
  }
}

void Guard::take_strikes() noexcept {
  for (std::size_t c = 0; c < kChannels; ++c) {
    Strike strike;
    if (!spikes_[c].next(strike)) continue;
    if (c > 0) wheelsets_.strike(strike.tick);
    rhythm_[c].add(strike.tick);
    SpikeTally& tally = spike_tally_[c];
    if (!strike.digital || rhythm_[c].regular()) {
      ++inputs_.impacts[c];
      tally.impacts += 1.0;
      continue;
    }
    tally.wrong += 1.0;
    wrong_[wrong_pushed_++ % wrong_.size()] = {strike.tick, c};
    log_.spoil(FaultKind::kSpikes, channel_of(c), strike.tick - 1, strike.tick + 1);
    if (tally.count < kPending)
      tally.pending[tally.count++] = {strike.tick, static_cast<double>(strike.height) * unit(c)};
  }
}

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
      const Spike& spike = tally.pending[i];
      log_.report(FaultKind::kSpikes, channel_of(channel), log_.seconds(spike.tick),
                  spike.height_mps2);
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
  for (Contacts& contacts : contacts_) contacts.count *= kTallyKept;
  judge_twins();
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

// Time that the samples carry against the rate that was declared: blocks in a row whose ends say
// another one, and together more than a burst can be late.
void Guard::judge_time(const Sample& sample) noexcept {
  const auto since = [&](std::int64_t tick, std::int64_t time_ns) {
    return SpanOfTime{static_cast<double>(sample.tick - tick),
                      1e-9 * static_cast<double>(sample.time_ns - time_ns)};
  };
  const SpanOfTime block = since(block_start_, block_start_ns_);
  if (!(block.seconds > 0.0)) return;
  if (!(std::abs(block.rate_hz() / config_.sample_rate_hz - 1.0) > kWrongRate)) {
    wrong_rate_blocks_ = 0;
    return;
  }
  if (wrong_rate_blocks_++ == 0) {
    wrong_rate_from_ = block_start_;
    wrong_rate_from_ns_ = block_start_ns_;
  }
  const SpanOfTime all = since(wrong_rate_from_, wrong_rate_from_ns_);
  const double off = std::abs(all.samples - all.seconds * config_.sample_rate_hz);
  if (wrong_rate_blocks_ < kRateBlocks || off < CounterSequence::kBurstTicks) return;
  log_.report(FaultKind::kWrongSampleRate, FaultChannel::kAll, log_.seconds(block_start_),
              all.rate_hz());
}

void Guard::finish() noexcept {
  settle_jumps(std::numeric_limits<std::int64_t>::max() / 2);
  for (SpikeWatch& watch : spikes_) watch.finish();
  for (std::size_t i = 0; i < wrong_.size() / kChannels; ++i) take_strikes();
  if (any_ && last_.tick > block_start_) close_block(last_.tick);
}

}  // namespace dampline
