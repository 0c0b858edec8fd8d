// SPDX-License-Identifier: MIT
#include "app/live/interface.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <system_error>
#include <utility>

#include "app/error.hpp"
#include "app/fleet/spool.hpp"
#include "app/identify/source.hpp"
#include "app/live/digital_lines.hpp"
#include "app/live/process.hpp"
#include "app/live/recorder.hpp"
#include "app/mqtt/publisher.hpp"
#include "app/record/frames.hpp"
#include "app/run/disk.hpp"
#include "app/run/json.hpp"
#include "app/serve/metrics.hpp"
#include "app/serve/serving.hpp"
#include "app/text/format.hpp"
#include "drivers/blackbox/writer.hpp"
#include "drivers/os/system_clock.hpp"
#include "drivers/socketcan/link.hpp"
#include "drivers/socketcan/source.hpp"

namespace dampline::app {
namespace {

constexpr std::int64_t kKib = 1024;

std::unique_ptr<drivers::SocketCanSource> open_bus(const Config& config,
                                                   const std::string& interface,
                                                   const AssemblerConfig& assembler,
                                                   const hal::Clock& clock,
                                                   const hal::RunTime& run_time) {
  drivers::SocketCanConfig bus;
  bus.interface = interface;
  for (const ChannelConfig& channel : assembler.channels)
    bus.identifiers.push_back({channel.id, channel.extended});
  for (const std::optional<ChannelConfig>& extra : assembler.extras)
    if (extra) bus.identifiers.push_back({extra->id, extra->extended});
  bus.receive_buffer_bytes = static_cast<int>(config.input.can.receive_buffer_kib * kKib);
  bus.run_time = run_time;
  const auto link = drivers::read_link(interface);
  if (!link.ok()) throw RunError{link.error_text()};
  for (const std::string& text : drivers::link_warnings(link.value())) warn(text);
  auto source = drivers::SocketCanSource::open(bus, clock);
  if (!source.ok()) throw RunError{source.error_text()};
  return std::move(source.value());
}

std::unique_ptr<hal::RecordSink> open_sink(const BlackboxSettings& settings,
                                           const std::string& interface,
                                           const std::filesystem::path& folder) {
  if (folder.empty()) return std::make_unique<VoidSink>();
  drivers::BlackboxConfig blackbox;
  blackbox.directory = folder;
  blackbox.rotate_bytes = static_cast<std::uint64_t>(settings.rotate_mib * kKib * kKib);
  blackbox.rotate_ns = std::llround(1e9 * settings.rotate_s);
  blackbox.keep_bytes = static_cast<std::uint64_t>(settings.keep_mib * kKib * kKib);
  blackbox.keep_ns = std::llround(1e9 * settings.keep_s);
  blackbox.reserve_free_bytes = static_cast<std::uint64_t>(settings.reserve_free_mib * kKib * kKib);
  blackbox.sync_interval_ns = std::llround(1e9 * settings.sync_s);
  blackbox.interfaces = {interface};
  auto sink = drivers::BlackboxWriter::open(blackbox);
  if (!sink.ok()) throw RunError{sink.error_text()};
  return std::move(sink.value());
}

void publish_files(const LivePlace& place, const RunResult& result, const std::string& text) {
  std::error_code removed;  // the run directory, which is made again
  std::filesystem::create_directories(place.run, removed);
  write_file(place.run / "live.json", text);
  if (!place.status.empty()) write_file(place.status, text);
  if (!place.metrics.empty()) write_file(place.metrics, metrics_text(result, nullptr));
}

std::vector<InputFile> inputs_of(const Config& config, const std::string& interface) {
  std::vector<InputFile> out{{interface, "interface", 0, ""}};
  if (!config.input.can.dbc.empty()) out.push_back(describe_input(config.input.can.dbc, "dbc"));
  return out;
}

/// As [spool] says; null: no segments are kept.
std::unique_ptr<fleet::Spool> open_spool(const Config& config) {
  if (config.spool.folder.empty()) return nullptr;
  if (!config.model.velocity_corner_hz)
    warn(
        "[spool]: the sensors' noise chooses the velocity's drift filter, so that states of two "
        "runs may not merge; [model] velocity_corner_hz states it");
  return std::make_unique<fleet::Spool>(config.spool, config.record);
}

void end_mqtt(MqttPublisher& mqtt, RunResult& result) {
  mqtt.end(to_json(result));
  if (const std::uint64_t lost = mqtt.waiting() + mqtt.dropped(); lost > 0)
    result.warnings.push_back(fmt::format("MQTT: {} alarms have not reached the broker.", lost));
}

/// Every segment's state into the spool; what the spool has to say is among the run's warnings.
void keep_segments(fleet::Spool& spool, const Config& config, const std::vector<InputFile>& inputs,
                   LiveOutlets& outlets) {
  const std::uint64_t boot = std::uint64_t{std::random_device{}()} << 32U;
  outlets.segment = [&spool, &config, &inputs, boot](const SegmentState& state,
                                                     const std::string& alarms) {
    SegmentFile file = describe_segment(state, config, inputs, boot, alarms);
    spool.put(file.about.segment, std::move(file.bytes));
  };
  outlets.describe = [&spool](RunResult& result) {
    for (std::string& text : spool.warnings()) result.warnings.push_back(std::move(text));
  };
}

}  // namespace

Identified identify_live(const Config& config, const std::string& interface,
                         const LiveOptions& options, const LivePlace& place) {
  static_cast<void>(estimator_config(config));  // wrong settings before a wrong source
  const drivers::SystemClock clock;
  const hal::RunTime run_time = hal::RunTime::start(clock);
  const AssemblerConfig assembler = can_channels(config);
  const auto source = open_bus(config, interface, assembler, clock, run_time);
  const auto sink = open_sink(config.blackbox, interface, place.blackbox);
  DigitalLines lines{config.gpio, run_time};
  const NotifyEnvironment environment = NotifyEnvironment::take();
  Notifier notifier{environment.socket};
  Watchdog watchdog{notifier, environment.watchdog_ns};
  Progress progress{place.show_progress};
  LiveOptions live = options;
  live.record = !place.blackbox.empty();
  const auto serving = open_serving(config);
  const auto mqtt = open_mqtt(config);
  const auto spool = open_spool(config);
  const std::vector<InputFile> inputs = inputs_of(config, interface);
  LiveOutlets outlets;
  outlets.begin = [&](Recorder& recorder) {
    lines.start(recorder);
    notifier.ready("waiting for samples");
  };
  outlets.turn = [&](const LiveTurn& turn) {
    lines.show(turn.state, turn.alarm, turn.now_ns);
    watchdog.look(turn.heartbeats, turn.now_ns);
    if (serving)
      serving->turn(
          {name_of(turn.state), turn.samples, 1e-9 * static_cast<double>(turn.silence_ns)});
  };
  outlets.rotated = [&] {
    notifier.reloading();
    notifier.ready("a new black box file was begun");
  };
  outlets.end = [&] {
    lines.stop();
    notifier.stopping();
  };
  outlets.publish = [&](const RunResult& result) {
    const std::string line = status_line(result);
    notifier.status(line);
    progress.show({}, 0.0, line);
    const std::string text = to_json(result);
    if (serving) serving->publish(result, text);
    if (mqtt) mqtt->publish(text);
    publish_files(place, result, text);
  };
  if (spool) keep_segments(*spool, config, inputs, outlets);
  outlets.alarm = [&](const AlarmChange& change, double time_s) {
    if (mqtt) mqtt->tell(change, time_s);
  };
  LiveParts parts{interface, source.get(), sink.get(), &clock, run_time, inputs};
  if (serving) parts.tap = &serving->tap();
  LiveRun run{config, assembler, parts, live, std::move(outlets)};
  Identified found = run.run();
  lines.describe(found.result);
  if (mqtt) end_mqtt(*mqtt, found.result);
  return found;
}

}  // namespace dampline::app
