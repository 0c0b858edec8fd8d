// SPDX-License-Identifier: MIT
#include "app/inspect/check.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "app/error.hpp"
#include "app/identify/source.hpp"
#include "app/identify/truck_run.hpp"
#include "app/inspect/parts.hpp"
#include "app/inspect/values.hpp"
#include "app/live/digital_lines.hpp"
#include "app/record/columns.hpp"
#include "app/record/frames.hpp"
#include "app/record/rate.hpp"
#include "app/record/source_kind.hpp"
#include "app/rig/record.hpp"
#include "dampline/sample/assembler.hpp"

namespace dampline::app {
namespace {

constexpr std::array<std::string_view, kExtras> kMassOfExtra{"frame_pitch_mass_kg", "far_mass_kg"};
constexpr std::array<Column, kExtras> kExtraColumns{Column::kFrameEndAccel, Column::kFarFrameAccel};

/// The first key of [input.can] that names something; empty: none does.
std::string frame_key(const CanConfig& can) {
  const auto named = [](const auto& texts) {
    return std::any_of(texts.begin(), texts.end(), [](const auto& t) { return !t.empty(); });
  };
  if (!can.dbc.empty()) return "dbc";
  if (named(can.accel) || named(can.extra_accel)) return "frame_accel";
  if (named(can.counter)) return "frame_counter";
  return can.interface.empty() ? "" : "interface";
}

/// The first key of [input.columns] or [input.scale] that says something; empty: none does.
std::string table_key(const InputConfig& input) {
  for (std::size_t i = 0; i < kColumns; ++i) {
    if (!input.columns[i].empty()) return fmt::format("[input.columns] {}", kColumnNames[i]);
    if (input.scale[i] != 1.0) return fmt::format("[input.scale] {}", kColumnNames[i]);
  }
  return "";
}

bool names_truck_columns(const InputConfig& input) {
  return std::any_of(kTruckColumns.begin(), kTruckColumns.end(),
                     [&](Column c) { return !input.columns[index(c)].empty(); });
}

void check_lines(const GpioConfig& gpio) {
  if (gpio.chip.empty() && (!gpio.edges.empty() || !gpio.lamp.empty()))
    throw UsageError{"[gpio] chip: found none, expected one, since edges or a lamp are named"};
  for (const std::string& edge : gpio.edges) static_cast<void>(parse_edge_line(edge));
  if (!gpio.lamp.empty()) static_cast<void>(parse_lamp_line(gpio.lamp));
}

void check_extras(const Config& config) {
  const auto wanted = config.car.extras();
  for (std::size_t e = 0; e < kExtras; ++e) {
    const bool named = !config.input.can.extra_accel[e].empty() ||
                       !config.input.columns[index(kExtraColumns[e])].empty();
    if (named && !wanted[e])
      throw UsageError{fmt::format(
          "[car] {}: found none, expected it, since {} is named and nothing reads that without it",
          kMassOfExtra[e], name(kExtraColumns[e]))};
  }
}

}  // namespace

void check_configuration(const Config& config) {
  check_lines(config.gpio);
  check_extras(config);
  const std::string frames = frame_key(config.input.can);
  const std::string table = table_key(config.input);
  if (!frames.empty() && !table.empty())
    throw UsageError{
        fmt::format("{}: nothing reads it beside [input.can] {}: frames have their unit and factor "
                    "from the DBC file; expected one of the two",
                    table, frames)};
  if (!frames.empty()) static_cast<void>(can_channels(config));
  if (!frames.empty() || names_truck_columns(config.input))
    static_cast<void>(estimator_config(config));
}

namespace {

constexpr double kCheckedS = 60.0;

/// Of one channel, in m/s^2.
std::string text_of(const Values& values) {
  if (values.count() == 0) return "no number";
  return fmt::format("rms {:.4g} m/s^2 about {:.3g}, from {:.4g} to {:.4g}{}", values.rms(),
                     values.mean(), values.least(), values.most(),
                     values.moves() ? "" : ": it does not move");
}

/// Frames or rows of a record's beginning as samples.
class Beginning {
 public:
  Beginning(const Config& config, SampleFeed& feed) : rate_hz_{truck_rate_hz(config.input)} {
    const RecordSignals signals = feed.signals();
    const AssemblerConfig wanted{signals.channels, signals.extras, rate_hz_};
    assembler_ = std::make_unique<SampleAssembler>(
        SampleAssembler::check(wanted).ok() ? wanted : AssemblerConfig{});
  }
  void read(SampleFeed& feed) {
    for (bool more = true; more && !is_enough();) {
      const Batch batch = feed.read();
      for (const CanFrame& frame : batch.frames) {
        assembler_->push(frame);
        take_complete();
      }
      for (const Sample& sample : batch.samples) take(sample);
      more = batch.more;
      if (!more) assembler_->flush();
      take_complete();
    }
  }
  [[nodiscard]] std::uint64_t samples() const noexcept { return samples_; }
  [[nodiscard]] MeasuredRate rate() const noexcept { return assembler_->measured_rate(); }
  [[nodiscard]] FrameSummary frames() const noexcept { return {assembler_->counts(), 0}; }
  [[nodiscard]] const std::array<Values, kChannels>& readings() const noexcept { return readings_; }

 private:
  [[nodiscard]] bool is_enough() const noexcept {
    return static_cast<double>(samples_) >= kCheckedS * rate_hz_;
  }
  void take_complete() {
    for (Sample sample; assembler_->pop(sample);) take(sample);
  }
  void take(const Sample& sample) noexcept {
    ++samples_;
    for (std::size_t c = 0; c < kChannels; ++c) readings_[c].take(sample.accel_mps2[c]);
  }

  double rate_hz_;
  std::unique_ptr<SampleAssembler> assembler_;
  std::uint64_t samples_{0};
  std::array<Values, kChannels> readings_{};
};

std::string name_of_channel(const InputConfig& input, SourceKind kind, std::size_t c) {
  return kind == SourceKind::kTruckRows ? input.header(kTruckColumns[c]) : can_signal(input, c);
}

std::string check_truck(const Config& config, const SourceOptions& source, SourceKind kind) {
  static_cast<void>(estimator_config(config));
  const auto feed = open_feed(config, source, kind);
  Beginning beginning{config, *feed};
  beginning.read(*feed);
  if (beginning.samples() == 0)
    throw UsageError{fmt::format("{}: no complete sample with this configuration: {}", source.path,
                                 feed->explain_emptiness(beginning.frames()))};
  const MeasuredRate rate = feed->rate().value_or(beginning.rate());
  try {
    static_cast<void>(make_correction(rate, truck_rate_hz(config.input), source.path));
  } catch (const RunError& error) {
    throw UsageError{error.what()};  // it is the configuration's rate that is wrong
  }
  std::string text = fmt::format("{}: right with it: {} samples at {:.3f} Hz\n", source.path,
                                 beginning.samples(), rate.rate_hz);
  for (std::size_t c = 0; c < kChannels; ++c)
    fmt::format_to(std::back_inserter(text), "  {} ({}): {}\n", kTruckChannels[c],
                   name_of_channel(config.input, kind, c), text_of(beginning.readings()[c]));
  return text;
}

/// Tables that a truck reads, and a rig does not.
void refuse_truck_tables(const Config& config, const std::string& source) {
  constexpr std::array<std::string_view, 5> kRead{"record", "input", "input.columns", "input.scale",
                                                  "model"};
  for (const std::string& table : config.tables)
    if (std::find(kRead.begin(), kRead.end(), table) == kRead.end())
      throw UsageError{fmt::format("[{}]: nothing reads it: {} is a rig's record; expected [{}]",
                                   table, source, fmt::join(kRead, "], ["))};
}

std::string check_rig(const Config& config, const SourceOptions& source) {
  refuse_truck_tables(config, source.path);
  const rig::Record record = rig::csv_record(source.path, config.input, source.skip_bad_lines);
  const auto rows = record.open();
  std::uint64_t count = 0;
  for (rig::Line line; rows->next(line);) ++count;
  return fmt::format("{}: right with it: {} rows of a rig at {:.6g} Hz\n", source.path, count,
                     1.0 / rig::measure_interval_s(record));
}

}  // namespace

std::string check_against_record(const Config& config, const SourceOptions& source) {
  const RecognisedColumns seen = recognise_columns(config, source);
  const SourceKind kind = detect_source(seen.config, source);
  if (kind == SourceKind::kInterface)
    throw UsageError{fmt::format("{}: is an interface, expected a record", source.path)};
  const bool table = kind == SourceKind::kTruckRows || kind == SourceKind::kRigRows;
  const std::string unread = table ? frame_key(config.input.can) : table_key(config.input);
  if (!unread.empty())
    throw UsageError{fmt::format("{}{}: nothing reads it: {} holds {}", table ? "[input.can] " : "",
                                 unread, source.path, table ? "columns, no frames" : "frames")};
  std::string text;
  for (const std::string& note : seen.notes) text += fmt::format("  {}\n", note);
  if (kind == SourceKind::kRigRows) return check_rig(seen.config, source) + text;
  return check_truck(with_record_rate(seen.config, source, kind), source, kind) + text;
}

}  // namespace dampline::app
