// SPDX-License-Identifier: MIT
#include "dampline/guard/spectral_guard.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "dampline/sample/hole_bridge.hpp"

namespace dampline {
namespace {

constexpr double kMovingMps2 = 0.3;  // rms of the wheelsets below which nothing is judged
constexpr double kMatch = 0.35;      // of the wheelsets' whitened correlation
constexpr double kSwapped = 1.0;     // fast power of the frame over a wheelset's; clean 0.02
// Of the match: a frame among the wheelsets moves with the other one at once, too. Wheelsets that
// roll slowly, so that friction holds the frame, do not, and the frame has as much power as they.
constexpr double kAtOnce = 0.3;
constexpr int kBlocksInARow = 2;             // before a lasting fault is named
constexpr std::uint32_t kFirstSegments = 3;  // of the block that finds the delay
constexpr int kAligned = 2;                  // samples
constexpr double kSteadyS = 100e-6;          // change of the delay in a block
constexpr double kGainSignificant = 6.5;     // clean records stay below 4
constexpr double kGainAtOnce = 0.6;          // of the range
constexpr double kLeastGainChange = 0.012;
constexpr std::size_t kGainBlocks = 7;
constexpr double kWrongDelayRatio = 0.003;
constexpr int kWrongDelayBlocks = 4;  // a timing step is named by then
constexpr double kNoiseRatio = 3.5;   // of power, 1.9 times the declared deviation
constexpr std::array<std::size_t, kChannels> kNoiseBlocks{3, 8, 8};  // the wheelsets' scatter more
// Over the median. Of the frame the power of a block scatters by a third where friction holds it,
// and a median of the first five may be half of what it should be.
constexpr std::array<double, 2> kBurstRatio{6.0, 10.0};  // frame, wheelsets: they scatter more
// Over the median, of the scatter of one block. A filter with a high corner leaves friction's own
// fast part in the band, and the noise beside it may come out as nothing in half of the blocks.
constexpr double kBurstScatter = 8.0;
constexpr double kLeastRise = 0.75;  // of the band's power, of a burst's
constexpr double kRiseScatter = 4.0;
constexpr double kNoisy = 4.0;  // over the usual noise of the wheelsets: no block to judge gain by
constexpr double kWhite = 1.4;
// Of the wheelsets' incoherent power: it is known that well in many blocks and in one.
constexpr double kLevelDoubt = 0.3;
constexpr double kBurstDoubt = 1.2;
constexpr double kImpulseShare = 1.5;  // impulses fall off towards half the rate, noise does not
constexpr double kBridgeDoubt = 1.5;   // of the noise that bridged holes make
constexpr double kLasting = 1.4;       // noise over the usual difference of the wheelsets
constexpr std::size_t kBurstBlocks = 5;
constexpr std::uint64_t kFewImpacts = 3;  // a block

}  // namespace

SpectralGuard::SpectralGuard(const GuardConfig& config) noexcept
    : config_{config},
      spectra_{config.sample_rate_hz},
      survey_{config.sample_rate_hz, config.anti_alias},
      timing_{config.sample_rate_hz},
      places_{config.sample_rate_hz} {}

void SpectralGuard::restart() noexcept {
  spectra_.restart();
  timing_.restart();
  survey_.forget_lag();
  aligned_ = has_delay_ = usable_ = steady_ = false;
}

void SpectralGuard::advance(FaultLog& log, GuardInputs& inputs) noexcept {
  if (spectra_.advance()) {
    const SpectrumSums& sums = spectra_.sums();
    if (aligned_) {
      timing_.add_segment(spectra_.segment().tick,
                          static_cast<double>(sums.delay) / config_.sample_rate_hz +
                              spectra_.segment().excess_delay_s);
    }
    const std::uint32_t enough = aligned_ ? PairSpectra::kSegmentsPerBlock : kFirstSegments;
    if (sums.segments >= enough && !survey_.busy() && next_ == Test::kNone) {
      survey_.start(spectra_.take());
    }
    return;
  }
  if (next_ != Test::kNone) {
    judge(log, inputs);
    return;
  }
  if (survey_.busy() && survey_.advance()) take_block(log);
}

void SpectralGuard::take_block(FaultLog& log) noexcept {
  const BlockFigures& block = survey_.figures();
  const std::uint32_t spoilt = log.spoilt(block.first_tick, block.last_tick);
  const bool moving = block.wheelset_mps2 > kMovingMps2;
  if (moving && spoilt == 0) next_ = Test::kOrder;
}

void SpectralGuard::judge(FaultLog& log, GuardInputs& inputs) noexcept {
  const Test now = next_;
  next_ = Test::kNone;
  switch (now) {
    case Test::kNone:
      return;
    case Test::kOrder:
      count_impacts(inputs);
      if (!in_order(log)) return;
      align();
      next_ = Test::kTiming;
      return;
    case Test::kTiming:
      if (timing_.add_block(survey_.figures(), usable_, inputs)) {
        survey_.forget_lag();
        gain_.clear();  // it scatters otherwise
      }
      timing_.judge(log, inputs);
      next_ = Test::kGain;
      return;
    case Test::kGain:
      following_.add(survey_.figures().following, survey_.figures().last_tick);
      if (usable_ && few_impacts_[1] && few_impacts_[2]) judge_gain(log);
      places_.start(survey_.sums(), survey_.figures());
      next_ = Test::kPlaces;
      return;
    case Test::kPlaces:
      next_ = places_.advance(log) ? Test::kRate : Test::kPlaces;
      return;
    case Test::kRate:
      if (steady_) judge_rate(log);
      next_ = Test::kNoise;
      return;
    case Test::kNoise:
      judge_noise(log);
      next_ = Test::kBurst;
      return;
    case Test::kBurst:
      judge_burst(log, 0);
      judge_burst(log, 1);
      return;
  }
}

void SpectralGuard::count_impacts(const GuardInputs& inputs) noexcept {
  for (std::size_t c = 0; c < kChannels; ++c) {
    few_impacts_[c] = inputs.impacts[c] - impacts_before_[c] < kFewImpacts;
    impacts_before_[c] = inputs.impacts[c];
  }
}

// Frame and wheelset exchanged; a sensor upside down; the wheelsets exchanged.
bool SpectralGuard::in_order(FaultLog& log) noexcept {
  const BlockFigures& block = survey_.figures();
  const double time_s = log.seconds(block.first_tick);
  const auto lasting = [](int& blocks, bool now) {
    blocks = now ? blocks + 1 : 0;
    return blocks >= kBlocksInARow;
  };
  const bool swapped =
      block.frame_power > kSwapped && block.at_once > kAtOnce * std::abs(block.match);
  if (lasting(swapped_blocks_, swapped)) {
    log.report(FaultKind::kSwappedChannels, FaultChannel::kAll, time_s, block.frame_power);
  }
  if (swapped) return false;
  const bool opposite = block.match < -kMatch;
  const bool frame_down = !opposite && block.following < 0.0;
  const std::array<bool, kChannels> down{frame_down, opposite && block.follow[0] < block.follow[1],
                                         opposite && block.follow[0] >= block.follow[1]};
  for (std::size_t c = 0; c < kChannels; ++c) {
    if (lasting(inverted_blocks_[c], down[c])) {
      log.report(FaultKind::kWrongPolarity, channel_of(c), time_s, -1.0);
    }
  }
  if (opposite || frame_down) return false;
  const int expected = config_.leading == Leading::kUnknown     ? 0
                       : config_.leading == Leading::kWheelset1 ? 1
                                                                : -1;
  const bool reversed = block.match > kMatch && block.match_delay * expected < 0;
  if (lasting(reversed_blocks_, reversed)) {
    log.report(FaultKind::kSwappedChannels, FaultChannel::kWheelsets, time_s, block.match);
  }
  return true;
}

void SpectralGuard::align() noexcept {
  const BlockFigures& block = survey_.figures();
  const bool matches = block.match > kMatch;
  const bool side_by_side = matches && std::abs(block.match_delay - block.delay) <= kAligned;
  const bool followed =
      std::exchange(usable_, aligned_ && side_by_side && block.coherent_share > 0.5);
  steady_ = followed && usable_ && has_delay_ && std::abs(block.delay_s - delay_s_) < kSteadyS;
  if (usable_) {
    delay_s_ = block.delay_s;
    has_delay_ = true;
    spectra_.set_weights(survey_.weights());
  } else {
    timing_.discard_segments(block.first_tick);
  }
  if (!matches) return;
  aligned_ = true;
  spectra_.set_delay(block.match_delay);
}

void SpectralGuard::judge_gain(FaultLog& log) noexcept {
  const BlockFigures& block = survey_.figures();
  if (is_noisy(block)) return;  // a burst would pass for a change of gain
  gain_.add(block.log_gain, (block.first_tick + block.last_tick) / 2);
  if (gain_.size() < kGainBlocks) return;
  const BlockSeries::Step step = gain_.step();
  if (step.significance <= kGainSignificant || std::abs(step.size) <= kLeastGainChange) return;
  if (step.block + BlockSeries::kSide + 1 > gain_.size()) return;  // wait for one block more
  const std::int64_t tick = (gain_.tick(step.block) + gain_.tick(step.block - 1)) / 2;
  const double change = gain_.change_at(tick);
  const bool at_once = std::abs(change) > kGainAtOnce * gain_.range();
  log.report(FaultKind::kGainChange, FaultChannel::kWheelsets,
             log.seconds(at_once ? tick : gain_.tick(0)),
             100.0 * std::expm1(at_once ? change : gain_.change_since(gain_.tick(0))));
  if (at_once) gain_.drop(step.block + 1);
}

void SpectralGuard::judge_rate(FaultLog& log) noexcept {
  if (config_.wheelbase_m <= 0.0 || config_.speed_mps <= 0.0) return;
  // Where a channel is out of step or rings the delay says nothing of the rate.
  if (log.has(FaultKind::kRingingMount)) return;
  for (const FaultKind kind : {FaultKind::kClockDrift, FaultKind::kTimingStep,
                               FaultKind::kLostSamples, FaultKind::kRepeatedSamples}) {
    for (const FaultChannel channel :
         {FaultChannel::kWheelset1, FaultChannel::kWheelset2, FaultChannel::kWheelsets}) {
      if (log.find(kind, channel) != nullptr) return;
    }
  }
  const double delay_s = std::abs(timing_.delay_s());
  if (delay_s == 0.0) return;
  const double ratio = delay_s * config_.speed_mps / config_.wheelbase_m;
  wrong_rate_blocks_ = std::abs(ratio - 1.0) > kWrongDelayRatio ? wrong_rate_blocks_ + 1 : 0;
  if (wrong_rate_blocks_ < kWrongDelayBlocks) return;
  log.report(FaultKind::kWrongSampleRate, FaultChannel::kAll,
             log.seconds(survey_.figures().first_tick), config_.sample_rate_hz * ratio);
}

FrameFollow SpectralGuard::frame_follow() const noexcept {
  const double usual = following_.median();
  if (!(usual > 0.0)) return {.usual = usual};
  const BlockSeries::Step step = following_.step();
  const BlockSeries::Trend trend = following_.trend();
  return {usual, step.size / usual, step.significance, trend.total / usual, trend.significance};
}

double SpectralGuard::noise_mps2(std::size_t channel) const noexcept {
  const bool both = channel > 0 && white_.size() > 0;
  const BlockSeries& series = both ? white_ : noise_[0];
  if (series.size() == 0) return 0.0;
  const double density = series.median() * (both ? 0.5 : 1.0);
  return std::sqrt(0.5 * density * config_.sample_rate_hz);
}

double SpectralGuard::noise_limit(std::size_t channel) const noexcept {
  const double noise = config_.noise_mps2[channel];
  const double step = config_.step_mps2[channel];
  return kNoiseRatio * (noise * noise + step * step / 12.0) / (0.5 * config_.sample_rate_hz);
}

// Of the wheelsets, against the blocks before it.
bool SpectralGuard::is_noisy(const BlockFigures& block) const noexcept {
  if (noise_[1].size() < kBurstBlocks) return false;
  const double usual = std::max(noise_[1].median(), noise_limit(1) + noise_limit(2));
  const double now = block.noise[1] + block.noise[2] - kBurstDoubt * block.incoherent;
  return usual > 0.0 && now > kNoisy * usual;
}

void SpectralGuard::judge_noise(FaultLog& log) noexcept {
  const BlockFigures& block = survey_.figures();
  const std::int64_t middle = (block.first_tick + block.last_tick) / 2;
  for (std::size_t c = 0; c < kChannels; ++c) {
    if (!few_impacts_[c] || (c > 0 && !steady_)) continue;
    const double impulses = kImpulseShare * impulse_power_[c] / (0.5 * config_.sample_rate_hz);
    const double bridged =
        bridged_.noise_mps2[c] * bridged_.noise_mps2[c] / (0.5 * config_.sample_rate_hz);
    const double not_noise =
        kBridgeDoubt * bridged + (c > 0 ? kLevelDoubt * block.incoherent + impulses : 0.0);
    const double own = block.noise[c] * (c > 0 ? 1.0 - block.folded_share : 1.0);
    level_[c].add(std::max(own - not_noise, 0.0), middle);
    if (config_.noise_mps2[c] <= 0.0 || level_[c].size() < kNoiseBlocks[c]) continue;
    const BlockSeries newest = level_[c].newest(kNoiseBlocks[c] + 1);
    if (c > 0 && log.has(FaultKind::kSoftSaturation)) continue;  // it makes overtones
    const double noise_mps2 = std::sqrt(newest.median() * 0.5 * config_.sample_rate_hz);
    // Second differences of white noise have the root of six times its deviation; impacts do not
    // move their median.
    const bool white =
        change_mps2_[c] == 0.0 || std::sqrt(6.0) * noise_mps2 < kWhite * change_mps2_[c];
    const bool lasting = c == 0 || noise_mps2 < kLasting * difference_mps2_;
    if (newest.median() > noise_limit(c) && white && lasting) {
      log.report(FaultKind::kExcessNoise, channel_of(c), log.seconds(newest.tick(0)), noise_mps2);
    }
  }
  add_noise(noise_[0], kBurstRatio[0], block.noise[0], middle);
  frame_in_band_.add(block.frame_in_band, middle);
  if (!few_impacts_[1] || !few_impacts_[2] || !steady_) return;
  const double own = block.noise[1] + block.noise[2];
  const double doubt = kBurstDoubt * block.incoherent;
  add_noise(noise_[1], kBurstRatio[1], std::max(own - doubt, 0.0), middle);
  add_noise(white_, kBurstRatio[1], std::max((1.0 - block.folded_share) * own - doubt, 0.0),
            middle);
}

// Values that were put in are off by more now and then: they make no burst.
void SpectralGuard::add_noise(BlockSeries& series, double most, double power,
                              std::int64_t tick) const noexcept {
  if (bridged_.share > HoleBridge::kMany && series.size() > 0)
    power = std::min(power, most * series.median());
  series.add(power, tick);
}

// Noise that comes adds to all that is in its band; what is only told apart otherwise does not.
bool SpectralGuard::rises_with(double noise, std::size_t which, std::size_t block) const noexcept {
  const BlockSeries& in_band = which == 0 ? frame_in_band_ : noise_[1];
  const double rise = in_band[block] - in_band.median();
  return rise > kLeastRise * noise && rise > kRiseScatter * in_band.scatter();
}

void SpectralGuard::judge_burst(FaultLog& log, std::size_t which) noexcept {
  const BlockSeries& series = which == 0 ? noise_[0] : white_;
  if (series.size() < kBurstBlocks) return;
  const double declared = which == 0 ? noise_limit(0) : noise_limit(1) + noise_limit(2);
  const double usual = series.median();
  const double limit =
      std::max({kBurstRatio[which] * usual, usual + kBurstScatter * series.scatter(), declared});
  // The newest waits: what else spoils it may not be known yet.
  for (std::size_t i = 0; i + 1 < series.size(); ++i) {
    if (series[i] <= limit || series.tick(i) <= burst_tick_[which]) continue;
    if (!rises_with(series[i] - usual, which, i)) continue;
    burst_tick_[which] = series.tick(i);
    const auto half = PairSpectra::kHop * std::int64_t{PairSpectra::kSegmentsPerBlock + 1} / 2;
    if (log.spoilt(series.tick(i) - half, series.tick(i) + half) != 0) continue;
    const FaultChannel where = which == 0 ? FaultChannel::kFrame : FaultChannel::kWheelsets;
    log.spoil(FaultKind::kNoiseBurst, where, series.tick(i) - half, series.tick(i) + half);
    log.report(FaultKind::kNoiseBurst, where, log.seconds(series.tick(i)),
               std::sqrt(series[i] * 0.5 * config_.sample_rate_hz));
  }
}

}  // namespace dampline
