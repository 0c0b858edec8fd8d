// SPDX-License-Identifier: MIT
#include "sim_hw/record_faults.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dampline::sim {
namespace {

constexpr std::int64_t kRepeatEvery = 510;  // samples between samples that are sent twice

double hann_sinc(double x, double half) {
  if (std::abs(x) >= half) return 0.0;
  const double angle = std::numbers::pi * x;
  const double sinc = std::abs(x) < 1e-9 ? 1.0 : std::sin(angle) / angle;
  return sinc * 0.5 * (1.0 + std::cos(angle / half));
}

std::int64_t sample_of(double time_s) { return std::llround(time_s * kSampleRateHz); }

}  // namespace

FaultyRecord::FaultyRecord(const SimulationConfig& simulation, const RecordFaultConfig& faults)
    : simulation_config_(simulation),
      faults_(faults),
      simulation_(simulation),
      random_(simulation.seed, Stream::kFaults),
      ring_(static_cast<std::size_t>(kHistory)),
      repeats_left_(faults.repeated_everywhere) {
  for (std::size_t c = 0; c < kChannels; ++c) {
    for (int i = 0; i < faults.spikes[c]; ++i) {
      spike_ticks_[c].push_back(sample_of(faults.record_s * random_.uniform()));
    }
  }
  for (std::int64_t i = 0; i < kAhead; ++i) pull();
}

void FaultyRecord::pull() {
  ring_[static_cast<std::size_t>(pulled_ % kHistory)] = simulation_.next();
  ++pulled_;
}

const SimulatedSample& FaultyRecord::at(std::int64_t n) const {
  const std::int64_t oldest = std::max<std::int64_t>(pulled_ - kHistory, 0);
  return ring_[static_cast<std::size_t>(std::clamp(n, oldest, pulled_ - 1) % kHistory)];
}

double FaultyRecord::delay_samples(std::size_t channel, double time_s) const {
  double delay = faults_.clock_drift_ppm[channel] * 1e-6 * time_s * kSampleRateHz;
  if (time_s < faults_.start_s) return delay;
  delay += faults_.delay_step_s[channel] * kSampleRateHz;
  return delay + faults_.repeated_samples[channel] - faults_.lost_samples[channel];
}

// Whole samples are taken as they are; between them a sinc of 48 taps under a Hann window.
double FaultyRecord::delayed(std::size_t channel, double time_s) const {
  const double place = static_cast<double>(source_) - delay_samples(channel, time_s);
  const double whole = std::floor(place + 0.5);
  const auto n = static_cast<std::int64_t>(whole);
  const double u = place - whole;
  if (std::abs(u) < 1e-9) return at(n).accel_mps2[channel];
  double sum = 0.0;
  for (std::int64_t k = -kHalfTaps; k <= kHalfTaps; ++k) {
    sum += at(n + k).accel_mps2[channel] *
           hann_sinc(u - static_cast<double>(k), static_cast<double>(kHalfTaps));
  }
  return sum;
}

double FaultyRecord::distorted(std::size_t channel, double accel_mps2, double time_s) {
  double value = accel_mps2;
  if (const double limit = faults_.saturation_mps2[channel]; limit > 0.0) {
    value = limit * std::tanh(value / limit);
  }
  const bool begun = time_s >= faults_.start_s;
  if (begun) {
    const double length = std::max(faults_.end_s - faults_.start_s, 1e-9);
    const double progress = std::min((time_s - faults_.start_s) / length, 1.0);
    value *= 1.0 + faults_.gain_step[channel] + faults_.gain_drift[channel] * progress;
    value += faults_.dc_jump_mps2[channel];
  }
  double noise = faults_.noise_mps2[channel];
  if (begun && time_s < faults_.end_s) noise = std::hypot(noise, faults_.burst_mps2[channel]);
  return noise > 0.0 ? value + noise * random_.normal() : value;
}

void FaultyRecord::convert(SimulatedSample& sample, std::size_t channel, double accel_mps2) const {
  const double step = count_scale_mps2(simulation_config_.sensors.range_mps2[channel]);
  auto counts = static_cast<int>(std::lround(std::clamp(
      accel_mps2 / step, static_cast<double>(kMinCount), static_cast<double>(kMaxCount))));
  const int coarse = 1 << faults_.lost_bits[channel];
  if (coarse > 1) counts = (counts + 4096) / coarse * coarse - 4096;
  if (faults_.inverted[channel]) counts = std::min(-counts, kMaxCount);
  sample.counts[channel] = static_cast<std::int16_t>(counts);
  sample.accel_mps2[channel] = counts * step;
  const auto bit = static_cast<std::uint8_t>(1U << channel);
  sample.saturated = static_cast<std::uint8_t>(sample.saturated & ~bit);
  if (counts == kMaxCount || counts == kMinCount) {
    sample.saturated = static_cast<std::uint8_t>(sample.saturated | bit);
  }
}

SimulatedSample FaultyRecord::faulty(std::int64_t n) {
  SimulatedSample sample = at(n);
  const double time_s = static_cast<double>(n) / kSampleRateHz;
  const SimulatedSample clean = sample;
  for (std::size_t c = 0; c < kChannels; ++c) {
    const std::size_t from = faults_.source[c];
    double value = from == c ? delayed(c, time_s) : clean.accel_mps2[from];
    value = distorted(c, value, time_s);
    if (std::ranges::count(spike_ticks_[c], n) > 0) {
      value += random_.uniform() < 0.5 ? -faults_.spike_mps2 : faults_.spike_mps2;
    }
    convert(sample, c, value);
  }
  return sample;
}

SimulatedSample FaultyRecord::next() {
  const bool due = source_ % kRepeatEvery == 0 && source_ > sample_of(faults_.start_s);
  if (due && repeats_left_ > 0 && !repeated_) {
    --repeats_left_;
    repeated_ = true;
  } else {
    repeated_ = false;
    if (source_ == sample_of(faults_.start_s)) {
      source_ += faults_.lost_everywhere + faults_.counted_lost;
      tick_ += faults_.counted_lost;
    }
    while (pulled_ <= source_ + kAhead) pull();
    last_ = faulty(source_++);
  }
  last_.tick = tick_++;
  last_.time_s = static_cast<double>(last_.tick) / kSampleRateHz;
  return last_;
}

}  // namespace dampline::sim
