// SPDX-License-Identifier: MIT
#include "dampline/guard/pair_spectra.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dampline {
namespace {

// Slices: 32 calls to load, 72 for the transforms, 16 for the sums; a hop has 256.
constexpr std::size_t kLoadSlice = 16;
constexpr std::size_t kTransformSlice = 64;
constexpr std::size_t kSumSlice = 16;

}  // namespace

SpectrumBand SpectrumBand::between(double low_hz, double high_hz, double sample_rate_hz) noexcept {
  const double bin_hz = sample_rate_hz / static_cast<double>(Fourier512::kSize);
  const auto first = static_cast<std::size_t>(std::ceil(low_hz / bin_hz));
  const auto last = static_cast<std::size_t>(std::floor(high_hz / bin_hz));
  return {first, std::max(std::min(last, kSpectrumBins - 1), first - 1)};
}

void SpectrumSums::clear() noexcept {
  for (Real* real : {&frame, &wheelset1, &wheelset2, &delayed1, &mean}) real->fill(0.0);
  for (Cross* cross : {&wheelsets, &aligned, frame_to.data(), &frame_to[1]}) cross->fill({});
  segments = 0;
  delay = 0;
  first_tick = last_tick = 0;
}

PairSpectra::PairSpectra(double sample_rate_hz) noexcept : rate_hz_{sample_rate_hz} {
  for (std::size_t n = 0; n < window_.size(); ++n) {
    const double turn = static_cast<double>(n) / static_cast<double>(kSegment);
    window_[n] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * turn);
  }
  weights_.fill(1.0);
  restart();
}

void PairSpectra::restart() noexcept {
  count_ = 0;
  made_up_ = 0;
  next_end_ = kSegment + 2 * kMostDelay;
  stage_ = Stage::kIdle;
}

void PairSpectra::push(std::int64_t tick, const std::array<double, kChannels>& accel_mps2,
                       bool made_up) noexcept {
  ring_[static_cast<std::size_t>(count_) % kRing] = accel_mps2;
  ++count_;
  tick_ = tick;
  if (made_up) made_up_ = count_;
  if (count_ < next_end_) return;
  begin();
  next_end_ = count_ + kHop;
}

// The segment ends kMostDelay before the newest sample, so that wheelset 1 can be earlier, too.
void PairSpectra::begin() noexcept {
  start_ = count_ - kMostDelay - kSegment;
  start_tick_ = tick_ - kMostDelay - kSegment + 1;
  if (made_up_ > start_ - kMostDelay) return;
  delay_ = next_delay_;
  SpectrumSums& sums = sums_[open_];
  if (sums.segments == 0 || sums.delay != delay_) {
    sums.clear();
    sums.first_tick = start_tick_;
    sums.delay = delay_;
  }
  stage_ = Stage::kLoad;
  cursor_ = 0;
}

bool PairSpectra::advance() noexcept {
  switch (stage_) {
    case Stage::kIdle:
      return false;
    case Stage::kLoad:
      load();
      return false;
    case Stage::kTransform:
      transform();
      return false;
    case Stage::kSum:
      return sum();
  }
  return false;
}

void PairSpectra::load() noexcept {
  for (std::size_t i = 0; i < kLoadSlice; ++i, ++cursor_) {
    const std::int64_t n = start_ + static_cast<std::int64_t>(cursor_);
    const auto& a = at(n);
    const double w = window_[cursor_];
    wheelsets_.set(cursor_, {w * a[1], w * a[2]});
    frame_.set(cursor_, {w * a[0], w * at(n - delay_)[1]});
  }
  if (cursor_ < window_.size()) return;
  wheelsets_.start();
  frame_.start();
  stage_ = Stage::kTransform;
  cursor_ = 0;
}

void PairSpectra::transform() noexcept {
  if (cursor_ == 0) {
    if (wheelsets_.advance(kTransformSlice)) cursor_ = 1;
    return;
  }
  if (!frame_.advance(kTransformSlice)) return;
  stage_ = Stage::kSum;
  cursor_ = 1;
  phase_sum_ = weight_sum_ = 0.0;
}

bool PairSpectra::sum() noexcept {
  const std::size_t end = std::min(cursor_ + kSumSlice, kSpectrumBins);
  for (; cursor_ < end; ++cursor_) add_bin(cursor_);
  if (cursor_ < kSpectrumBins) return false;
  ++sums_[open_].segments;
  sums_[open_].last_tick = start_tick_ + kSegment - 1;
  figures_ = {.tick = start_tick_ + kSegment / 2,
              .excess_delay_s =
                  weight_sum_ > 0.0 ? -phase_sum_ / (2.0 * std::numbers::pi * weight_sum_) : 0.0};
  stage_ = Stage::kIdle;
  return true;
}

void PairSpectra::add_bin(std::size_t k) noexcept {
  SpectrumSums& sums = sums_[open_];
  const auto split = [k](const Fourier512& of, std::complex<double>& first,
                         std::complex<double>& second) {
    const std::complex<double> a = of[k];
    const std::complex<double> b = of[Fourier512::kSize - k];
    first = {0.5 * (a.real() + b.real()), 0.5 * (a.imag() - b.imag())};
    second = {0.5 * (a.imag() + b.imag()), 0.5 * (b.real() - a.real())};
  };
  const auto cross = [](const std::complex<double>& a,
                        const std::complex<double>& b) {  // conj(a) b
    return std::complex<double>{a.real() * b.real() + a.imag() * b.imag(),
                                a.real() * b.imag() - a.imag() * b.real()};
  };
  std::complex<double> one;
  std::complex<double> two;
  std::complex<double> frame;
  std::complex<double> delayed;
  split(wheelsets_, one, two);
  split(frame_, frame, delayed);
  const std::complex<double> mean = 0.5 * (one + two);
  sums.frame[k] += std::norm(frame);
  sums.wheelset1[k] += std::norm(one);
  sums.wheelset2[k] += std::norm(two);
  sums.delayed1[k] += std::norm(delayed);
  sums.mean[k] += std::norm(mean);
  sums.wheelsets[k] += cross(one, two);
  const std::complex<double> aligned = cross(delayed, two);
  sums.aligned[k] += aligned;
  sums.frame_to[0][k] += cross(one, frame);
  sums.frame_to[1][k] += cross(two, frame);
  if (const double weight = weights_[k]; weight > 0.0) {
    const double f_hz = static_cast<double>(k) * rate_hz_ / static_cast<double>(kSegment);
    phase_sum_ += weight * f_hz * phase_of(aligned);
    weight_sum_ += weight * f_hz * f_hz;
  }
}

const SpectrumSums& PairSpectra::take() noexcept {
  const SpectrumSums& ended = sums_[open_];
  open_ = 1 - open_;
  sums_[open_].clear();
  return ended;
}

}  // namespace dampline
