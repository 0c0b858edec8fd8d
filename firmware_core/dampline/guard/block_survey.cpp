// SPDX-License-Identifier: MIT
#include "dampline/guard/block_survey.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dampline {
namespace {

constexpr double kTiny = 1e-300;
constexpr double kLeastCoherence = 0.08;
constexpr double kMostCoherence = 0.98;
constexpr double kReferenceKept = 0.95;  // a block

/// a b, without the checks for infinities of operator*.
LagTracker::Complex times(const LagTracker::Complex& a, const LagTracker::Complex& b) noexcept {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

constexpr double kHannPower = 0.375;  // mean square of the window
constexpr double kCoherent = 0.4;
constexpr std::size_t kButterfliesSlice = 96;
constexpr double kMostWeight = 50.0;
constexpr int kAtOnceSamples = 2;
constexpr double kShakenHz = 85.0;     // below, wheelsets shake most, and not as 1 / f^2
constexpr double kLeastFolded = 0.45;  // corner, of the rate: then little of a slope is left

using Complex = std::complex<double>;

double edge_of(const AntiAliasConfig& filter) noexcept {
  return filter.thinned ? kThinnedEdge : 0.49;
}

double coherence(const Complex& cross, double a, double b) noexcept {
  return std::norm(cross) / (a * b + kTiny);
}

}  // namespace

double LagTracker::Bin::coherence() const noexcept {
  return std::norm(cross) / (frame * channel + kTiny);
}

int LagTracker::expected_samples() const noexcept {
  return static_cast<int>(std::lround(lag_s_ * rate_hz_));
}

LagTracker::Complex LagTracker::turned(std::size_t k, double lag_s,
                                       const Complex& x) const noexcept {
  const double turn = 2.0 * std::numbers::pi * hz(k) * lag_s;
  return times(x, {std::cos(turn), std::sin(turn)});
}

void LagTracker::start() noexcept {
  adopts_ = !has_reference_;
  coherence_ = phase_ = weight_ = 0.0;
}

LagTracker::Complex LagTracker::whitened(std::size_t k, const Bin& bin) noexcept {
  const double coherence = bin.coherence();
  coherence_ += coherence;
  if (adopts_) return {};
  const Complex product = times(bin.cross, std::conj(reference_[k]));
  return product * (coherence / (std::sqrt(std::norm(product)) + kTiny));
}

void LagTracker::add_phase(std::size_t k, const Bin& bin) noexcept {
  if (adopts_) return;
  const double coherence = std::min(bin.coherence(), kMostCoherence);
  const double weight = coherence / (1.0 - coherence);
  const Complex product = turned(k, static_cast<double>(lag_samples_) / rate_hz_,
                                 times(bin.cross, std::conj(reference_[k])));
  phase_ += weight * hz(k) * phase_of(product);
  weight_ += weight * hz(k) * hz(k);
}

void LagTracker::conclude(double bins_in_band) noexcept {
  valid_ = coherence_ / bins_in_band > kLeastCoherence;
  if (!valid_) return;
  lag_s_ = static_cast<double>(lag_samples_) / rate_hz_;
  if (weight_ > 0.0) lag_s_ -= phase_ / (2.0 * std::numbers::pi * weight_);
  if (adopts_) lag_s_ = 0.0;
}

void LagTracker::learn(std::size_t k, const Bin& bin) noexcept {
  if (!valid_) return;
  has_reference_ = true;
  if (adopts_) reference_[k] = {};
  reference_[k] = kReferenceKept * reference_[k] + turned(k, lag_s_, bin.cross);
}

// Bands in Hz for 300 samples a second; those near half the rate move with it.
BlockSurvey::BlockSurvey(double sample_rate_hz, const AntiAliasConfig& anti_alias) noexcept
    : rate_hz_{sample_rate_hz},
      bin_hz_{sample_rate_hz / static_cast<double>(Fourier512::kSize)},
      folds_{!anti_alias.thinned && anti_alias.of(1).corner_hz > 0.0 &&
             anti_alias.of(1).corner_hz < kLeastFolded * sample_rate_hz},
      shared_{band(4.0, 0.3 * sample_rate_hz)},
      follow_{band(1.1, 1.6)},
      fast_{band(40.0, 0.333 * sample_rate_hz)},
      lag_{band(15.0, 0.317 * sample_rate_hz)},
      middle_{band(0.15 * sample_rate_hz, 0.283 * sample_rate_hz)},
      noise_{band(0.333 * sample_rate_hz, edge_of(anti_alias) * sample_rate_hz)},
      incoherent_{band(0.367 * sample_rate_hz, 0.42 * sample_rate_hz)},
      apart_{band(std::clamp(kShakenHz, 0.283 * sample_rate_hz, 0.333 * sample_rate_hz),
                  0.45 * sample_rate_hz)},
      edge_{band((edge_of(anti_alias) - 0.03) * sample_rate_hz,
                 edge_of(anti_alias) * sample_rate_hz)},
      lags_{LagTracker{sample_rate_hz}, LagTracker{sample_rate_hz}, LagTracker{sample_rate_hz}} {
  for (std::size_t k = 1; k < kSpectrumBins; ++k) {
    alias_shape_[k] = leap_power(anti_alias.of(0), hz(k), rate_hz_);
    // The contact patch lets a wheelset's acceleration fall as 1 / f^2.
    const double from_hz = rate_hz_ - hz(k);
    folded_shape_[k] = passed_power(anti_alias.of(1), from_hz) / (from_hz * from_hz);
  }
}

void BlockSurvey::start(const SpectrumSums& sums) noexcept {
  block_ = &sums;
  s_ = {};
  figures_ = {.first_tick = sums.first_tick, .last_tick = sums.last_tick, .delay = sums.delay};
  for (LagTracker& lag : lags_) lag.start();
  round_ = 0;
  stage_ = Stage::kPower;
  cursor_ = 1;
}

bool BlockSurvey::advance() noexcept {
  const auto slice = [this](void (BlockSurvey::*work)(std::size_t) noexcept, Stage next) {
    const std::size_t end = std::min(cursor_ + kSlice, kSpectrumBins);
    for (; cursor_ < end; ++cursor_) (this->*work)(cursor_);
    if (cursor_ < kSpectrumBins) return false;
    stage_ = next;
    cursor_ = 1;
    return true;
  };
  switch (stage_) {
    case Stage::kDone:
      return false;
    case Stage::kPower:
      if (slice(&BlockSurvey::power, Stage::kLoad)) conclude_power();
      return false;
    case Stage::kLoad:
      if (slice(&BlockSurvey::load, Stage::kTransform)) correlation_.start();
      return false;
    case Stage::kTransform:
      if (correlation_.advance(kButterfliesSlice)) stage_ = Stage::kPeak;
      return false;
    case Stage::kPeak:
      find_peaks();
      stage_ = round_ == 0 ? Stage::kLoad : Stage::kPhase;
      ++round_;
      return false;
    case Stage::kPhase:
      if (slice(&BlockSurvey::phase, Stage::kReference)) conclude_lag();
      return false;
    case Stage::kReference:
      return slice(&BlockSurvey::learn, Stage::kDone);
  }
  return false;
}

// Behind the wheelsets' mean, and behind either of them.
LagTracker::Bin BlockSurvey::lag_bin(std::size_t which, std::size_t k) const noexcept {
  const SpectrumSums& b = *block_;
  if (which == 1) return {b.frame_to[0][k], b.frame[k], b.wheelset1[k]};
  if (which == 2) return {b.frame_to[1][k], b.frame[k], b.wheelset2[k]};
  return {0.5 * (b.frame_to[0][k] + b.frame_to[1][k]), b.frame[k], b.mean[k]};
}

void BlockSurvey::power(std::size_t k) noexcept {
  const SpectrumSums& b = *block_;
  weights_[k] = 0.0;
  if (shared_.holds(k)) {
    const double gamma2 = std::min(coherence(b.aligned[k], b.delayed1[k], b.wheelset2[k]), 1.0);
    if (gamma2 > kCoherent) s_.coherent += 1.0;
    weights_[k] = std::min(gamma2 / (1.0 - gamma2 + kTiny), kMostWeight);
    s_.phase += weights_[k] * hz(k) * phase_of(b.aligned[k]);
    s_.phase_weight += weights_[k] * hz(k) * hz(k);
    s_.log_ratio += 0.5 * std::log((b.delayed1[k] + kTiny) / (b.wheelset2[k] + kTiny));
    s_.power1 += b.delayed1[k];
    s_.power2 += b.wheelset2[k];
  }
  if (fast_.holds(k)) {
    s_.frame_fast += b.frame[k];
    s_.wheelset_fast += 0.5 * (b.wheelset1[k] + b.wheelset2[k]);
  }
  if (follow_.holds(k)) {
    for (std::size_t i = 0; i < 2; ++i) s_.follow[i] += b.frame_to[i][k].real();
    s_.follow_weight += b.mean[k];
  }
  if (noise_.holds(k)) {
    s_.frame.add(1.0 / (b.frame[k] + kTiny), alias_shape_[k], b.frame[k]);
  }
  if (middle_.holds(k)) {
    s_.middle += std::sqrt(b.delayed1[k] * b.wheelset2[k]);
    s_.shared_middle += std::sqrt(std::norm(b.aligned[k]));
  }
  if (incoherent_.holds(k)) {
    const double weight = 1.0 / (std::sqrt(b.delayed1[k] * b.wheelset2[k]) + kTiny);
    s_.shared_fast += weight * std::sqrt(std::norm(b.aligned[k]));
    s_.fast[0] += weight * b.delayed1[k];
    s_.fast[1] += weight * b.wheelset2[k];
    s_.fast_weight += weight;
  }
  if (apart_.holds(k)) {
    const double power = std::sqrt(b.delayed1[k] * b.wheelset2[k]);
    const double alike = s_.shared_middle / (s_.middle + kTiny);
    // It scatters in proportion to itself, and what is folded is most of it.
    s_.apart.add(1.0 / folded_shape_[k], folded_shape_[k],
                 std::min(alike, 1.0) * power - std::sqrt(std::norm(b.aligned[k])));
  }
  if (edge_.holds(k)) {
    s_.edge[0] += b.wheelset1[k];
    s_.edge[1] += b.wheelset2[k];
  }
}

void BlockSurvey::conclude_power() noexcept {
  const double density = 2.0 / (rate_hz_ * kHannPower * static_cast<double>(Fourier512::kSize) *
                                static_cast<double>(std::max<std::uint32_t>(block_->segments, 1U)));
  figures_.density = density;
  figures_.coherent_share = s_.coherent / shared_.bins();
  if (s_.phase_weight > 0.0) {
    figures_.delay_s = static_cast<double>(block_->delay) / rate_hz_ -
                       s_.phase / (2.0 * std::numbers::pi * s_.phase_weight);
  }
  figures_.log_gain = s_.log_ratio / shared_.bins();
  figures_.frame_power = s_.frame_fast / (s_.wheelset_fast + kTiny);
  figures_.wheelset_mps2 = std::sqrt(0.5 * density * bin_hz_ * (s_.power1 + s_.power2));
  figures_.follow = s_.follow;
  figures_.following = 0.5 * (s_.follow[0] + s_.follow[1]) / (s_.follow_weight + kTiny);
  figures_.noise[0] = density * s_.frame.white();
  figures_.frame_in_band = density * s_.frame.mean();
  conclude_noise(density);
}

// White noise of the wheelsets is what they do not share at 110-126 Hz, less the share that they do
// not have in common at 45-85 Hz either, where noise is small beside the motion. A part of that has
// the shape of motion that is folded at half the rate. Its sum for both scatters little; it goes to
// that wheelset which has the more power on its own.
void BlockSurvey::conclude_noise(double density) noexcept {
  figures_.incoherent_share = 1.0 - std::min(s_.shared_middle / (s_.middle + kTiny), 1.0);
  const double not_shared = (1.0 - figures_.incoherent_share) * incoherent_.bins() - s_.shared_fast;
  const double both = 2.0 * std::max(not_shared, 0.0) / (s_.fast_weight + kTiny);
  figures_.folded_share =
      folds_ ? std::max(1.0 - 2.0 * s_.apart.white() / (both + kTiny), 0.0) : 0.0;
  const double gain = std::exp(figures_.log_gain);
  std::array<double, 2> own{};
  for (std::size_t i = 0; i < 2; ++i) {
    const double shared = s_.shared_fast * (i == 0 ? gain : 1.0 / gain);
    own[i] = std::max((1.0 - figures_.incoherent_share) * s_.fast[i] - shared, 0.0);
  }
  for (std::size_t i = 0; i < 2; ++i) {
    const double mine = own[i] / (own[0] + own[1] + kTiny);
    figures_.noise[i + 1] = density * std::min(mine * both, s_.edge[i] / edge_.bins());
  }
  figures_.incoherent =
      density * figures_.incoherent_share * incoherent_.bins() / (s_.fast_weight + kTiny);
}

// Two correlations at once: their spectra are Hermitian, so the one is the real part of the
// transform and the other its imaginary part.
void BlockSurvey::load(std::size_t k) noexcept {
  const SpectrumSums& b = *block_;
  Complex first{};
  Complex second{};
  if (round_ == 0 && shared_.holds(k)) {
    first = std::conj(b.wheelsets[k]) / (std::sqrt(b.wheelset1[k] * b.wheelset2[k]) + kTiny);
  }
  if (lag_.holds(k)) {
    if (round_ == 1) first = std::conj(lags_[1].whitened(k, lag_bin(1, k)));
    const std::size_t which = round_ == 0 ? 0 : 2;
    second = std::conj(lags_[which].whitened(k, lag_bin(which, k)));
  }
  const auto turned = [](const Complex& x) { return Complex{-x.imag(), x.real()}; };  // i x
  correlation_.set(k, first + turned(second));
  correlation_.set(Fourier512::kSize - k, std::conj(first) + turned(std::conj(second)));
  if (k != 1) return;
  correlation_.set(0, {});
  correlation_.set(kSpectrumBins, {});
}

void BlockSurvey::find_peaks() noexcept {
  const auto at = [this](int lag) {
    return correlation_[static_cast<std::size_t>(lag + static_cast<int>(Fourier512::kSize)) %
                        Fourier512::kSize];
  };
  const auto first = [&](int lag) { return at(lag).real(); };
  const auto second = [&](int lag) { return at(lag).imag(); };
  if (round_ == 1) {
    lags_[1].find_peak(first);
    lags_[2].find_peak(second);
    return;
  }
  lags_[0].find_peak(second);
  constexpr auto kMost = static_cast<int>(PairSpectra::kMostDelay) - 4;
  double best = 0.0;
  double at_once = 0.0;
  for (int lag = -kAtOnceSamples; lag <= kAtOnceSamples; ++lag)
    at_once = std::max(at_once, std::abs(first(lag)));
  for (int lag = -kMost; lag <= kMost; ++lag) {
    if (std::abs(first(lag)) <= std::abs(best)) continue;
    best = first(lag);
    figures_.match_delay = lag;
  }
  figures_.match = best / (2.0 * shared_.bins());
  figures_.at_once = at_once / (2.0 * shared_.bins());
}

void BlockSurvey::phase(std::size_t k) noexcept {
  if (!lag_.holds(k)) return;
  for (std::size_t i = 0; i < lags_.size(); ++i) lags_[i].add_phase(k, lag_bin(i, k));
}

void BlockSurvey::conclude_lag() noexcept {
  figures_.has_lag = true;
  for (std::size_t i = 0; i < lags_.size(); ++i) {
    lags_[i].conclude(lag_.bins());
    figures_.has_lag = figures_.has_lag && lags_[i].valid();
    figures_.lag_s[i] = lags_[i].lag_s();
  }
}

void BlockSurvey::learn(std::size_t k) noexcept {
  if (!lag_.holds(k) || !figures_.has_lag) return;
  for (std::size_t i = 0; i < lags_.size(); ++i) lags_[i].learn(k, lag_bin(i, k));
}

}  // namespace dampline
