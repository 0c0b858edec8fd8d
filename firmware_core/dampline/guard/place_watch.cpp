// SPDX-License-Identifier: MIT
#include "dampline/guard/place_watch.hpp"

#include <algorithm>
#include <cmath>

namespace dampline {
namespace {

constexpr double kTinyPower = 1e-300;
constexpr double kPlacesKept = 0.98;  // a block
constexpr std::uint32_t kPlaceBlocks = 6;
constexpr double kFollows2 = 1.4;        // the frame's power over the wheelsets' at 1.2 Hz
constexpr double kNoiseOfPlaces = 1.5;   // times the noise that is known
constexpr double kRinging = 4.0;         // of a band over those beside it; sound records reach 1.8
constexpr double kOwnPeak = 2.5;         // the same of the channel alone: no gap of the others
constexpr int kRingingBlocks = 3;        // in a row
constexpr std::size_t kPlaceSlice = 16;  // bins a call
// Bands; lines of friction's own, at odd multiples of some 4 Hz, lie within.
constexpr std::size_t kBeside = 3;
constexpr std::size_t kFarBeside = 5;

/// A band's value over the highest of those beside it.
template <class Value>
double over_beside(const Value& value, std::size_t i) noexcept {
  double beside = kTinyPower;
  for (std::size_t j = kBeside; j <= kFarBeside; ++j)
    beside = std::max({beside, value(i - j), value(i + j)});
  return value(i) / beside;
}

}  // namespace

PlaceWatch::PlaceWatch(double sample_rate_hz) noexcept
    : bin_hz_{sample_rate_hz / static_cast<double>(Fourier512::kSize)},
      below_{SpectrumBand::between(1.1, 1.6, sample_rate_hz)},
      pitch_{SpectrumBand::between(3.5, 7.6, sample_rate_hz)},
      mounts_{SpectrumBand::between(15.0, 0.42 * sample_rate_hz, sample_rate_hz)} {
  const auto hold = [](SpectrumBand& band, std::size_t most) {
    band.last = std::min(band.last, band.first + most - 1);
  };
  hold(below_, kMostBins);
  hold(pitch_, kMostBins);
  hold(mounts_, kMostBands * kBandBins);
}

void PlaceWatch::start(const SpectrumSums& sums, const BlockFigures& figures) noexcept {
  block_ = &sums;
  density_ = figures.density;
  cursor_ = 1;
  frame_ = wheelsets_ = wheelset1_ = wheelset2_ = {};
  ++blocks_;
  const double white = figures.noise[0] + 0.25 * kFollows2 * (figures.noise[1] + figures.noise[2]);
  noise_ = kPlacesKept * noise_ + white * below_.bins();
}

bool PlaceWatch::advance(FaultLog& log) noexcept {
  const std::size_t end = std::min(cursor_ + kPlaceSlice, kSpectrumBins);
  for (; cursor_ < end; ++cursor_) add(cursor_);
  if (cursor_ < kSpectrumBins) return false;
  judge_mounts(log);
  return true;
}

void PlaceWatch::add(std::size_t k) noexcept {
  if (below_.holds(k)) add(k, below_bins_[k - below_.first]);
  if (pitch_.holds(k)) add(k, pitch_bins_[k - pitch_.first]);
  if (!mounts_.holds(k)) return;
  const std::size_t band = (k - mounts_.first) / kBandBins;
  frame_[band] += block_->frame[k];
  wheelsets_[band] += block_->wheelset1[k] + block_->wheelset2[k];
  wheelset1_[band] += block_->delayed1[k];
  wheelset2_[band] += block_->wheelset2[k];
}

void PlaceWatch::add(std::size_t k, Bin& bin) const noexcept {
  const SpectrumSums& b = *block_;
  const auto join = [this](auto& sum, const auto& now) {
    sum = kPlacesKept * sum + density_ * now;
  };
  join(bin.frame, b.frame[k]);
  join(bin.mean, b.mean[k]);
  join(bin.wheelset1, b.wheelset1[k]);
  join(bin.wheelset2, b.wheelset2[k]);
  join(bin.mean_frame, 0.5 * (b.frame_to[0][k] + b.frame_to[1][k]));
  join(bin.difference_frame, 0.5 * (b.frame_to[0][k] - b.frame_to[1][k]));
  join(bin.mean_difference,
       Complex{0.25 * (b.wheelset1[k] - b.wheelset2[k]), -0.5 * b.wheelsets[k].imag()});
}

// The shape of a channel over another, by bands; a peak of it is narrow.
void PlaceWatch::judge_mounts(FaultLog& log) noexcept {
  const std::size_t bands = (mounts_.last - mounts_.first + 1) / kBandBins;
  const std::array<std::array<const Bands*, 2>, kChannels> pairs{
      {{&frame_, &wheelsets_}, {&wheelset1_, &wheelset2_}, {&wheelset2_, &wheelset1_}}};
  for (std::size_t c = 0; c < kChannels; ++c) {
    const auto shape = [&](std::size_t i) {
      return (*pairs[c][0])[i] / ((*pairs[c][1])[i] + kTinyPower);
    };
    const auto own = [&](std::size_t i) { return (*pairs[c][0])[i]; };
    double highest = 0.0;
    std::size_t at = 0;
    for (std::size_t i = kFarBeside; i + kFarBeside < bands; ++i) {
      const double peak =
          std::min(over_beside(shape, i) / kRinging, over_beside(own, i) / kOwnPeak);
      if (peak <= highest) continue;
      highest = peak;
      at = i;
    }
    Ringing& ringing = ringing_[c];
    const bool there = at + 1 >= ringing.band && at <= ringing.band + 1;
    ringing.blocks = highest <= 1.0 ? 0 : there ? ringing.blocks + 1 : 1;
    ringing.band = at;
    if (ringing.blocks < kRingingBlocks) continue;
    const std::size_t middle = mounts_.first + at * kBandBins + kBandBins / 2;
    log.report(FaultKind::kRingingMount, channel_of(c), log.seconds(block_->first_tick),
               static_cast<double>(middle) * bin_hz_);
  }
}

Misplacement PlaceWatch::misplacement() const noexcept {
  if (blocks_ < kPlaceBlocks) return {};
  Misplacement out;
  double power = 0.0;
  double foreign = -kNoiseOfPlaces * noise_;
  for (std::size_t k = below_.first; k <= below_.last; ++k) {
    const Bin& b = below_bins_[k - below_.first];
    power += b.frame;
    foreign += b.frame - std::norm(b.mean_frame) / (b.mean + kTinyPower);
  }
  out.foreign_share = std::max(foreign, 0.0) / (power + kTinyPower);
  Complex seen{};
  double difference = 0.0;
  double told = 0.0;
  double left = 0.0;
  double first = 0.0;
  double second = 0.0;
  for (std::size_t k = pitch_.first; k <= pitch_.last; ++k) {
    const Bin& b = pitch_bins_[k - pitch_.first];
    const Complex cross =
        b.difference_frame - std::conj(b.mean_difference) * b.mean_frame / (b.mean + kTinyPower);
    const double half_difference = 0.5 * (b.wheelset1 + b.wheelset2) - b.mean;
    const double own = half_difference - std::norm(b.mean_difference) / (b.mean + kTinyPower);
    seen += cross;
    difference += own;
    first += b.wheelset1;
    second += b.wheelset2;
    told += std::norm(cross) / (own + kTinyPower);
    left += b.frame - std::norm(b.mean_frame) / (b.mean + kTinyPower);
  }
  out.difference = std::sqrt(std::norm(seen)) / (difference + kTinyPower);
  out.difference_share = told / (left + kTinyPower);
  out.gain = std::sqrt(first / (second + kTinyPower)) - 1.0;
  return out;
}

}  // namespace dampline
