// SPDX-License-Identifier: MIT
#include "dampline/dampline.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <new>

#include "dampline/identifier.hpp"

namespace {

using namespace dampline;

static_assert(DAMPLINE_CHANNELS == kChannels);
static_assert(DAMPLINE_CURVE_POINTS == kCurveSegments);

SignalLayout layout_of(const dampline_signal& s) noexcept {
  return {.start_bit = s.start_bit,
          .length = s.length,
          .order = s.motorola ? ByteOrder::kMotorola : ByteOrder::kIntel,
          .is_signed = s.is_signed,
          .scale = s.scale,
          .offset = s.offset,
          .minimum = s.minimum,
          .maximum = s.maximum};
}

ChannelConfig channel_of(const dampline_channel& c) noexcept {
  return {.id = c.id,
          .extended = c.extended,
          .accel = layout_of(c.accel),
          .has_counter = c.counter.length > 0,
          .counter = layout_of(c.counter)};
}

IdentifierConfig config_of(const dampline_config& config) noexcept {
  IdentifierConfig out;
  out.estimator.sample_rate_hz = config.sample_rate_hz;
  out.estimator.moving_mass_kg = config.moving_mass_kg;
  out.estimator.anti_alias = {config.anti_alias_corner_hz, config.anti_alias_order};
  out.guard.wheelbase_m = config.wheelbase_m;
  out.guard.speed_mps = config.speed_mps;
  for (std::size_t c = 0; c < kChannels; ++c) {
    out.signals[c] = ::channel_of(config.channels[c]);
    out.guard.noise_mps2[c] = config.channels[c].noise_mps2;
    if (config.channels[c].accel.length > 0)
      out.estimator.screen.step_mps2[c] = std::abs(config.channels[c].accel.scale);
  }
  return out;
}

bool takes_frames(const dampline_config& config) noexcept {
  return std::any_of(std::begin(config.channels), std::end(config.channels),
                     [](const dampline_channel& each) { return each.accel.length > 0; });
}

using OfSamples =
    BasicIdentifier<Parts{.frames = false, .densities = false, .phase = false, .alarms = false}>;

bool is_valid(const dampline_config& config) noexcept {
  return takes_frames(config) ? EmbeddedIdentifier::check(config_of(config)).ok()
                              : OfSamples::check(config_of(config)).ok();
}

dampline_estimate plain(const Estimate& each) noexcept { return {each.value, each.std}; }

dampline_snapshot plain(const Snapshot& from) noexcept {
  dampline_snapshot out{};
  out.valid = from.valid;
  out.tick = from.tick;
  out.coulomb_n = plain(from.coulomb_n);
  out.stiffness_npm = plain(from.stiffness_npm);
  out.viscous_nspm = plain(from.viscous_nspm);
  out.held_out_nmse = from.held_out_nmse;
  out.velocity_rms_mps = from.velocity_rms_mps;
  out.std_is_lower_bound = from.std_is_lower_bound;
  out.samples = from.counts.samples;
  out.samples_lost = from.counts.lost;
  out.blocks = from.blocks_in_estimate;
  for (std::size_t i = 0; i < kCurveSegments; ++i) {
    out.curve_velocity_mps[i] = from.curve[i].velocity_mps;
    out.curve_n[i] = {from.curve[i].force_n, from.curve[i].std_n};
  }
  return out;
}

}  // namespace

/// What a program in C holds a pointer to.
struct dampline_identifier {
  explicit dampline_identifier(const dampline_config& config) noexcept
      : corridor{config_of(config)} {}
  EmbeddedIdentifier corridor;
};
static_assert(alignof(dampline_identifier) <= alignof(long double));

extern "C" {

size_t dampline_size(void) { return sizeof(dampline_identifier); }

void dampline_default_config(dampline_config* config) {
  const EstimatorConfig defaults{};
  *config = dampline_config{};
  config->sample_rate_hz = defaults.sample_rate_hz;
  config->moving_mass_kg = defaults.moving_mass_kg;
  config->anti_alias_corner_hz = defaults.anti_alias.corner_hz;
  config->anti_alias_order = defaults.anti_alias.order;
}

dampline_identifier* dampline_create(void* memory, size_t size, const dampline_config* config) {
  const auto address = reinterpret_cast<std::uintptr_t>(memory);
  if (memory == nullptr || size < sizeof(dampline_identifier) ||
      address % alignof(dampline_identifier) != 0 || !is_valid(*config))
    return nullptr;
  return new (memory) dampline_identifier{*config};  // NOLINT(cppcoreguidelines-owning-memory)
}

void dampline_push_frame(dampline_identifier* self, const dampline_frame* frame) {
  CanFrame own{.time_ns = frame->time_ns,
               .id = frame->id,
               .length = std::min<std::uint8_t>(frame->length, sizeof frame->data),
               .extended = frame->extended};
  std::copy_n(frame->data, own.length, own.data.begin());
  self->corridor.push(own);
}

void dampline_push_sample(dampline_identifier* self, const dampline_sample* sample) {
  Sample own{.tick = sample->tick, .time_ns = sample->time_ns, .saturated = sample->saturated};
  std::copy_n(sample->accel_mps2, kChannels, own.accel_mps2.begin());
  self->corridor.push(own);
}

void dampline_finish(dampline_identifier* self) { self->corridor.finish(); }

void dampline_get_snapshot(dampline_identifier* self, dampline_snapshot* out) {
  *out = plain(self->corridor.snapshot());
}

uint32_t dampline_fault_count(const dampline_identifier* self) {
  return static_cast<std::uint32_t>(self->corridor.guard().faults().size());
}

bool dampline_get_fault(const dampline_identifier* self, uint32_t index, dampline_fault* out) {
  if (index >= self->corridor.guard().faults().size()) return false;
  const Fault& fault = self->corridor.guard().faults()[index];
  *out = {name_of(fault.kind), name_of(fault.channel), fault.unit,
          fault.size,          fault.time_s,           fault.last_s};
  return true;
}

}  // extern "C"
