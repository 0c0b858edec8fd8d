// SPDX-License-Identifier: MIT
#include "app/record/frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "app/error.hpp"
#include "dampline/motion/decimator.hpp"
#include "dampline/sample/assembler.hpp"
#include "drivers/dbc/channel.hpp"
#include "drivers/dbc/parse.hpp"
#include "sim_hw/nodes.hpp"

namespace dampline::app {

namespace {

constexpr std::array<std::string_view, kExtras> kExtraNames{"frame_end", "far_frame"};

std::string default_signal(std::string_view message) { return fmt::format("{}.ACCEL_Z", message); }

ChannelConfig channel(const drivers::Dbc& dbc, const InputConfig& input, std::size_t c) {
  auto found = drivers::channel_from(dbc, can_signal(input, c), input.can.counter[c]);
  if (!found.ok())
    throw UsageError{
        fmt::format("[input.can] {}_accel: {}", kTruckChannels[c], found.error_text())};
  ChannelConfig result = found.value();
  if (const auto range = input.range_mps2[c]) {
    result.accel.minimum = -*range;
    result.accel.maximum = *range;
  }
  return result;
}

ChannelConfig extra(const drivers::Dbc& dbc, const InputConfig& input, std::size_t e) {
  const std::string& named = input.can.extra_accel[e];
  const std::string signal = named.empty() ? default_signal(sim::kExtraMessageNames[e]) : named;
  auto found = drivers::channel_from(dbc, signal, "");
  if (!found.ok())
    throw UsageError{fmt::format("[input.can] {}_accel: {}", kExtraNames[e], found.error_text())};
  return found.value();
}

/// Of different names, too: a DBC file may describe the same bits twice.
bool is_one_signal(const ChannelConfig& a, const ChannelConfig& b) {
  const bool page = a.multiplexed && b.multiplexed && a.multiplexor_value != b.multiplexor_value;
  return a.id == b.id && a.extended == b.extended && !page &&
         a.accel.start_bit == b.accel.start_bit && a.accel.length == b.accel.length &&
         a.accel.order == b.accel.order;
}

void check_distinct(const AssemblerConfig& assembler, const drivers::Dbc& dbc) {
  std::vector<std::pair<std::string_view, const ChannelConfig*>> all;
  for (std::size_t c = 0; c < kChannels; ++c)
    all.emplace_back(kTruckChannels[c], &assembler.channels[c]);
  for (std::size_t e = 0; e < kExtras; ++e)
    if (assembler.extras[e]) all.emplace_back(kExtraNames[e], &*assembler.extras[e]);
  for (auto later = all.begin(); later != all.end(); ++later)
    for (auto earlier = all.begin(); earlier != later; ++earlier)
      if (is_one_signal(*earlier->second, *later->second))
        throw UsageError{
            fmt::format("[input.can] {0}_accel: is the same signal of {1} as {2}_accel, expected "
                        "one for each channel",
                        later->first, dbc.file, earlier->first)};
}

void refuse_factors(const InputConfig& input) {
  for (std::size_t i = 0; i < kColumns; ++i)
    if (input.scale[i] != 1.0)
      throw UsageError{fmt::format(
          "[input.scale] {}: found {}, expected none: frames have their unit and factor from the "
          "DBC file",
          kColumnNames[i], input.scale[i])};
}

}  // namespace

drivers::Dbc open_dbc(const std::string& path) {
  auto dbc = path.empty()
                 ? drivers::parse_dbc(sim::dbc_text({}, {}, true), "the project's own sensors")
                 : drivers::load_dbc(path);
  if (!dbc.ok()) throw UsageError{fmt::format("[input.can] dbc: {}", dbc.error_text())};
  return std::move(dbc.value());
}

std::string can_signal(const InputConfig& input, std::size_t c) {
  return input.can.accel[c].empty() ? default_signal(sim::kMessageNames[c]) : input.can.accel[c];
}

AssemblerConfig can_channels(const Config& config) {
  if (decimation(config.input.sample_rate_hz) > 1)
    throw UsageError{fmt::format(
        "[input] sample_rate_hz: found {}, expected at most 400 for CAN frames; CSV files may have "
        "more",
        config.input.sample_rate_hz)};
  refuse_factors(config.input);
  const drivers::Dbc dbc = open_dbc(config.input.can.dbc);
  AssemblerConfig assembler;
  assembler.sample_rate_hz = config.input.sample_rate_hz;
  for (std::size_t c = 0; c < kChannels; ++c) assembler.channels[c] = channel(dbc, config.input, c);
  const auto wanted = config.car.extras();
  for (std::size_t e = 0; e < kExtras; ++e)
    if (wanted[e]) assembler.extras[e] = extra(dbc, config.input, e);
  check_distinct(assembler, dbc);
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

void describe_frames(const hal::SourceHealth& health, const AssemblerCounts& counts,
                     RunResult& result) {
  const FrameLedger ledger = ledger_of(counts, health.dropped);
  result.counts.insert(result.counts.end(), {{"frames", health.frames},
                                             {"frames_sent", ledger.sent},
                                             {"frames_processed", ledger.processed},
                                             {"frames_dropped", ledger.kernel_drops},
                                             {"frames_missing", ledger.gaps},
                                             {"frames_excluded", ledger.excluded},
                                             {"frames_error", ledger.error},
                                             {"frames_foreign", ledger.foreign},
                                             {"frames_repeated", ledger.repeated},
                                             {"frames_late", ledger.too_late},
                                             {"frames_out_of_step", ledger.out_of_step},
                                             {"frames_wrong_length", ledger.wrong_length},
                                             {"frames_not_data", ledger.not_data},
                                             {"frames_other_page", ledger.other_page},
                                             {"frames_without_partner", ledger.without_partner},
                                             {"frames_reordered", health.reordered},
                                             {"lines_malformed", health.malformed},
                                             {"lines_ignored", health.ignored},
                                             {"incomplete", counts.incomplete},
                                             {"restarts", counts.restarts}});
  if (health.truncated)
    result.warnings.emplace_back(
        "The record was cut off in the middle of its last frame; what is before that frame was "
        "used.");
  if (health.malformed > 0)
    result.warnings.push_back(
        fmt::format("{} malformed or damaged frames were skipped.", health.malformed));
}

void IdentifierCounts::take(std::span<const CanFrame> frames) {
  for (const CanFrame& frame : frames) {
    if (taken_ == kMost) return;
    if (frame.error) continue;
    ++counts_[{frame.id, frame.extended}];
    ++taken_;
  }
}

std::string IdentifierCounts::busiest() const {
  constexpr std::size_t kShown = 8;
  std::vector<std::pair<Identifier, std::uint64_t>> sorted{counts_.begin(), counts_.end()};
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::string out;
  for (std::size_t i = 0; i < std::min(kShown, sorted.size()); ++i)
    out += fmt::format("{}0x{:X}{} ({})", i == 0 ? "" : ", ", sorted[i].first.first,
                       sorted[i].first.second ? " extended" : "", sorted[i].second);
  if (sorted.size() > kShown) out += fmt::format(" and {} more", sorted.size() - kShown);
  return out;
}

std::string explain_no_sample(const hal::SourceHealth& health, const AssemblerCounts& counts,
                              const std::array<ChannelConfig, kChannels>& channels) {
  std::string readings;
  for (std::size_t c = 0; c < kChannels; ++c)
    readings += fmt::format("{}0x{:X}: {}", c == 0 ? "" : ", ", channels[c].id,
                            counts.channels[c].readings);
  return fmt::format(
      "of {} frames ({} malformed ones skipped), {} had other identifiers than [input."
      "can] names; readings by identifier {}; {} instants lacked a channel",
      counts.frames, health.malformed, counts.foreign, readings, counts.incomplete);
}

namespace {

/// By the number of the kind; the black box's format fixes the numbers.
constexpr std::array<std::string_view, 28> kEventNames{
    "unknown",           "run_start",         "run_end",         "link_down",     "link_up",
    "interface_removed", "interface_back",    "bus_off",         "bus_restarted", "bus_error",
    "frames_dropped",    "clock_step",        "signal_lost",     "signal_back",   "records_lost",
    "recording_stopped", "recording_resumed", "file_rotated",    "pulse",         "marker_on",
    "marker_off",        "wheel_pulse",       "impossible_edge", "edges_lost",    "publish_failed",
    "publish_resumed",   "alarm_raised",      "alarm_cleared"};

}  // namespace

std::string_view name_of(hal::EventKind kind) noexcept {
  const auto number = static_cast<std::size_t>(kind);
  return number < kEventNames.size() ? kEventNames[number] : kEventNames[0];
}

void EventList::describe(std::int64_t first_time_ns, RunResult& result) const {
  std::vector<hal::Event> sorted = events_;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const hal::Event& a, const hal::Event& b) { return a.time_ns < b.time_ns; });
  for (const hal::Event& event : sorted)
    result.events.push_back({1e-9 * static_cast<double>(event.time_ns - first_time_ns),
                             std::string{name_of(event.kind)}, event.line, event.value});
  result.events_more = more_;
}

}  // namespace dampline::app
