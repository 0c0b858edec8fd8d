// SPDX-License-Identifier: MIT
#include "app/identify/can_channels.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "app/error.hpp"
#include "app/identify/thinner.hpp"
#include "drivers/dbc/channel.hpp"
#include "drivers/dbc/parse.hpp"
#include "sim_hw/nodes.hpp"

namespace dampline::app {
namespace {

constexpr std::array<std::string_view, kChannels> kKeys{"frame", "wheelset1", "wheelset2"};

std::string default_signal(std::size_t channel) {
  return fmt::format("{}.ACCEL_Z", sim::kMessageNames[channel]);
}

drivers::Dbc open_dbc(const std::string& path) {
  auto dbc = path.empty() ? drivers::parse_dbc(sim::dbc_text({}, {}), "the project's own sensors")
                          : drivers::load_dbc(path);
  if (!dbc.ok()) throw UsageError{fmt::format("[input.can] dbc: {}", dbc.error_text())};
  return std::move(dbc.value());
}

ChannelConfig channel(const drivers::Dbc& dbc, const InputConfig& input, std::size_t c) {
  const std::string signal = input.can.accel[c].empty() ? default_signal(c) : input.can.accel[c];
  auto found = drivers::channel_from(dbc, signal, input.can.counter[c]);
  if (!found.ok())
    throw UsageError{fmt::format("[input.can] {}_accel: {}", kKeys[c], found.error_text())};
  ChannelConfig result = found.value();
  if (const auto range = input.range_mps2[c]) {
    result.accel.minimum = -*range;
    result.accel.maximum = *range;
  }
  return result;
}

}  // namespace

AssemblerConfig can_channels(const Config& config) {
  if (thinning(config.input.sample_rate_hz) > 1)
    throw UsageError{fmt::format(
        "[input] sample_rate_hz: found {}, expected at most 400 for CAN frames; CSV files may have "
        "more",
        config.input.sample_rate_hz)};
  const drivers::Dbc dbc = open_dbc(config.input.can.dbc);
  AssemblerConfig assembler;
  assembler.sample_rate_hz = config.input.sample_rate_hz;
  for (std::size_t c = 0; c < kChannels; ++c) assembler.channels[c] = channel(dbc, config.input, c);
  if (!SampleAssembler::check(assembler).ok())
    throw UsageError{
        fmt::format("[input.can]: the signals of {} cannot be assembled at {} Hz: one lies "
                    "outside its frame, or the rate is out of range",
                    dbc.file, config.input.sample_rate_hz)};
  return assembler;
}

ScreenConfig screen_of(const std::array<ChannelConfig, kChannels>& channels) {
  ScreenConfig screen;
  for (std::size_t c = 0; c < kChannels; ++c)
    screen.step_mps2[c] = std::fabs(channels[c].accel.scale);
  return screen;
}

}  // namespace dampline::app
