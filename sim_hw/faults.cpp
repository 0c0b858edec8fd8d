// SPDX-License-Identifier: MIT
#include "sim_hw/faults.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "sim_hw/effects/registry.hpp"

namespace dampline::sim {
namespace {
constexpr std::int64_t kSwapDelayNs = 30'000;  // below the distance of the nodes' frames
}

Transport::Transport(const TransportConfig& config, std::uint64_t seed)
    : config_(config),
      random_(seed, Stream::kTransport),
      swap_done_(config.swap_time_s < 0.0),
      active_(config.loss_fraction > 0.0 || config.swap_fraction > 0.0 || !swap_done_) {}

Transport::Held* Transport::held_for(std::uint32_t id) noexcept {
  const auto found = std::ranges::find_if(
      held_, [&](const Held& held) { return held.full && held.frame.id == id; });
  return found == held_.end() ? nullptr : &*found;
}

bool Transport::swaps(std::size_t position, double time_s) noexcept {
  if (!swap_done_ && position == 0 && time_s >= config_.swap_time_s) {
    swap_done_ = true;
    return true;
  }
  return config_.swap_fraction > 0.0 && random_.uniform() < config_.swap_fraction;
}

std::span<const CanFrame> Transport::pass(const std::array<CanFrame, kChannels>& frames,
                                          double time_s) noexcept {
  count_ = 0;
  for (std::size_t i = 0; i < kChannels; ++i) {
    const CanFrame& frame = frames[i];
    if (!active_) {
      emit(frame);
      continue;
    }
    if (config_.loss_fraction > 0.0 && random_.uniform() < config_.loss_fraction) continue;
    if (Held* held = held_for(frame.id)) {
      emit(frame);
      CanFrame late = held->frame;
      late.time_ns = frame.time_ns + kSwapDelayNs;
      emit(late);
      held->full = false;
    } else if (swaps(i, time_s)) {
      *std::ranges::find(held_, false, &Held::full) = {true, frame};
    } else {
      emit(frame);
    }
  }
  std::stable_sort(out_.begin(), out_.begin() + static_cast<std::ptrdiff_t>(count_),
                   [](const CanFrame& a, const CanFrame& b) { return a.time_ns < b.time_ns; });
  return {out_.data(), count_};
}

namespace {

struct Range {
  std::string_view name;
  double fallback;
  double minimum;
  double maximum;
};

constexpr double kAnyTime = 1e9;
constexpr std::array<Range, 1> kLoss{{{"fraction", 0.05, 0.0, 1.0}}};
constexpr std::array<Range, 2> kSwap{
    {{"fraction", 0.0, 0.0, 1.0}, {"time_s", -1.0, -1.0, kAnyTime}}};
constexpr std::array<Range, 2> kClipping{
    {{"channel", 1.0, 0.0, 2.0}, {"range_mps2", 3.0, 1e-3, 1e4}}};
constexpr std::array<Range, 2> kSoftClipping{
    {{"channel", 1.0, 0.0, 2.0}, {"limit_mps2", 3.0, 1e-3, 1e4}}};
constexpr std::array<Range, 3> kStuck{{{"channel", 1.0, 0.0, 2.0},
                                       {"start_s", 100.0, 0.0, kAnyTime},
                                       {"end_s", 130.0, 0.0, kAnyTime}}};

using Values = std::span<const double>;
std::size_t channel_of(Values v) { return static_cast<std::size_t>(v[0]); }

struct Fault {
  std::string_view name;
  std::span<const Range> parameters;
  void (*set)(SimulationConfig& config, TransportConfig& transport, Values values);
};

constexpr std::array<Fault, 5> kFaults{{
    {"loss", kLoss,
     [](SimulationConfig&, TransportConfig& transport, Values v) {
       transport.loss_fraction = v[0];
     }},
    {"swap", kSwap,
     [](SimulationConfig&, TransportConfig& transport, Values v) {
       transport.swap_fraction = v[0];
       transport.swap_time_s = v[1];
     }},
    {"clipping", kClipping,
     [](SimulationConfig& config, TransportConfig&, Values v) {
       config.sensors.range_mps2[channel_of(v)] = v[1];
     }},
    {"soft_clipping", kSoftClipping,
     [](SimulationConfig& config, TransportConfig&, Values v) {
       config.sensors.limit_mps2[channel_of(v)] = v[1];
     }},
    {"stuck", kStuck,
     [](SimulationConfig& config, TransportConfig&, Values v) {
       config.sensors.stuck_start_s[channel_of(v)] = v[1];
       config.sensors.stuck_end_s[channel_of(v)] = v[2];
     }},
}};

std::optional<std::string> fill(const Fault& fault, const EffectValues& given,
                                std::span<double> values) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = fault.parameters[i].fallback;
  for (const auto& [name, value] : given) {
    const auto found = std::ranges::find(fault.parameters, name, &Range::name);
    if (found == fault.parameters.end()) {
      return fmt::format("fault {}: unknown parameter '{}', expected one of {}", fault.name, name,
                         names_of(fault.parameters));
    }
    if (!(value >= found->minimum && value <= found->maximum)) {
      return fmt::format("fault {}: {} is {}, expected {} to {}", fault.name, name, value,
                         found->minimum, found->maximum);
    }
    values[static_cast<std::size_t>(found - fault.parameters.begin())] = value;
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> add_fault_text(SimulationConfig& config, TransportConfig& transport,
                                          std::string_view text) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::string_view name = text.substr(0, colon);
  const auto fault = std::ranges::find(kFaults, name, &Fault::name);
  if (fault == kFaults.end()) {
    return fmt::format("unknown fault '{}', expected one of {}", name, names_of(kFaults));
  }
  EffectValues given;
  if (auto error = parse_values(text.substr(std::min(colon + 1, text.size())), given)) {
    return fmt::format("fault {}: {}", name, *error);
  }
  std::array<double, 3> values{};
  const auto used = std::span{values}.first(fault->parameters.size());
  if (auto error = fill(*fault, given, used)) return error;
  fault->set(config, transport, used);
  return std::nullopt;
}

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
double FaultyRecord::delayed(std::size_t channel, double time_s) {
  double place = static_cast<double>(source_) - delay_samples(channel, time_s);
  if (faults_.jitter_s[channel] > 0.0) {
    late_s_[channel] = faults_.jitter_s[channel] * random_.normal();
    place += late_s_[channel] * kSampleRateHz;
  }
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
    const double left_s = faults_.dc_jump_time_s - (time_s - faults_.start_s);
    const double moved = left_s > 0.0 ? 1.0 - left_s / faults_.dc_jump_time_s : 1.0;
    value += moved * faults_.dc_jump_mps2[channel];
  }
  double noise = faults_.noise_mps2[channel];
  if (begun && time_s < faults_.end_s) noise = std::hypot(noise, faults_.burst_mps2[channel]);
  return noise > 0.0 ? value + noise * random_.normal() : value;
}

bool FaultyRecord::is_open(std::size_t channel, std::int64_t n, double time_s) {
  const double opens_hz = faults_.opens_hz[channel];
  if (!(opens_hz > 0.0) || time_s < faults_.start_s || time_s >= faults_.end_s) return false;
  if (n >= open_until_[channel] && random_.uniform() < opens_hz / kSampleRateHz)
    open_until_[channel] = n + 1 + sample_of(0.002 + 0.048 * random_.uniform());
  return n < open_until_[channel];
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
    if (is_open(c, n, time_s)) value = faults_.open_mps2;
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

Sample FaultyRecord::stamped() const {
  Sample out = to_sample(last_);
  if (!faults_.jitter_is_stamped) return out;
  out.time_ns += std::llround(1e9 * late_s_[0]);
  for (std::size_t w = 0; w < 2; ++w)
    out.wheelset_after_us[w] =
        static_cast<std::int16_t>(std::lround(1e6 * (late_s_[w + 1] - late_s_[0])));
  return out;
}

}  // namespace dampline::sim
