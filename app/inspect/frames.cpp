// SPDX-License-Identifier: MIT
#include "app/record/frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "app/error.hpp"
#include "app/identify/source.hpp"
#include "app/inspect/parts.hpp"
#include "app/live/process.hpp"
#include "dampline/sample/signal.hpp"
#include "drivers/blackbox/shelf.hpp"
#include "drivers/blackbox/source.hpp"
#include "drivers/dbc/channel.hpp"
#include "drivers/dbc/parse.hpp"
#include "drivers/os/system_clock.hpp"
#include "drivers/record/frames.hpp"
#include "drivers/socketcan/source.hpp"

namespace dampline::app {
namespace {

constexpr std::size_t kFrameBatch = 256;
constexpr std::size_t kMostIdentifiers = 4096;  // a bus has some hundreds
constexpr std::chrono::milliseconds kPatience{100};

/// One signal of the DBC file and what the frames made of it.
struct Decoded {
  const drivers::DbcSignal* signal;
  SignalReader reader;
  SignalFinding finding;
};

/// The signals of one message, in the order of the DBC file.
class Message {
 public:
  Message(const drivers::Dbc& dbc, const drivers::DbcMessage& message) {
    for (const drivers::DbcSignal& signal : message.signals) {
      if (signal.multiplexing == drivers::Multiplexing::kMultiplexor && is_valid(signal.layout))
        multiplexor_.emplace_back(signal.layout);
      if (signal.is_float || !is_valid(signal.layout) || signal.layout.length > 53 ||
          signal.multiplexing == drivers::Multiplexing::kExtended)
        continue;
      SignalFinding finding;
      finding.name = fmt::format("{}.{}", message.name, signal.name);
      finding.unit = signal.unit;
      finding.resolution = std::fabs(signal.layout.scale);
      const auto channel = drivers::channel_from(dbc, finding.name, "");
      finding.acceleration = channel.ok() && !signal.unit.empty();
      if (finding.acceleration) finding.in_mps2 = channel.value().accel.scale / signal.layout.scale;
      signals_.push_back({&signal, SignalReader{signal.layout}, std::move(finding)});
    }
  }
  void take(const CanFrame& frame) {
    for (Decoded& each : signals_) {
      if (!each.reader.fits(frame) || !is_selected(*each.signal, frame)) continue;
      each.finding.values.take(each.reader.physical(each.reader.raw(frame)));
    }
  }
  /// With the rate of each.
  [[nodiscard]] std::vector<SignalFinding> findings(double frames_hz, std::uint64_t frames) const {
    std::vector<SignalFinding> out;
    for (const Decoded& each : signals_) {
      out.push_back(each.finding);
      out.back().rate_hz = frames_hz * static_cast<double>(each.finding.values.count()) /
                           static_cast<double>(std::max<std::uint64_t>(frames, 1));
    }
    return out;
  }

 private:
  [[nodiscard]] bool is_selected(const drivers::DbcSignal& signal, const CanFrame& frame) const {
    if (signal.multiplexing != drivers::Multiplexing::kMultiplexed) return true;
    return !multiplexor_.empty() && multiplexor_.front().fits(frame) &&
           multiplexor_.front().bits(frame) == signal.multiplexor_value;
  }

  std::vector<SignalReader> multiplexor_;  // one or none
  std::vector<Decoded> signals_;
};

/// What came with one identifier.
struct Traffic {
  IdentifierFinding finding;
  std::int64_t first_ns{0};
  std::int64_t last_ns{0};
  std::unique_ptr<Message> message;
};

class Survey {
 public:
  Survey(const drivers::Dbc& dbc, Inspection& found) : dbc_{dbc}, found_{found} {}

  void take(std::span<const CanFrame> frames) {
    for (const CanFrame& frame : frames) take(frame);
  }
  void conclude() {
    found_.count = count_;
    if (count_ > 0) found_.span_s = 1e-9 * static_cast<double>(last_ns_ - first_ns_);
    if (found_.clock != drivers::RecordClock::kRelative && count_ > 0)
      found_.start_s = 1e-9 * static_cast<double>(first_ns_);
    for (auto& [key, traffic] : traffic_) {
      IdentifierFinding& finding = traffic.finding;
      const double span_s = 1e-9 * static_cast<double>(traffic.last_ns - traffic.first_ns);
      if (span_s > 0.0) finding.rate_hz = static_cast<double>(finding.frames - 1) / span_s;
      if (traffic.message)
        finding.signals = traffic.message->findings(finding.rate_hz, finding.frames);
      found_.identifiers.push_back(std::move(finding));
    }
    std::stable_sort(found_.identifiers.begin(), found_.identifiers.end(),
                     [](const auto& a, const auto& b) { return a.frames > b.frames; });
    if (more_ > 0)
      found_.notes.push_back(
          fmt::format("{} frames of further identifiers are not listed.", more_));
  }

 private:
  void take(const CanFrame& frame) {
    if (count_++ == 0) first_ns_ = last_ns_ = frame.time_ns;
    const double pause_s = 1e-9 * static_cast<double>(frame.time_ns - last_ns_);
    last_ns_ = frame.time_ns;
    if (pause_s > Inspection::kGapS) ++found_.gaps;
    found_.longest_gap_s = std::max(found_.longest_gap_s, pause_s);
    if (frame.error) {
      ++found_.error_frames;
      return;
    }
    if (Traffic* traffic = traffic_of(frame); traffic != nullptr) take(frame, *traffic);
  }

  /// Null: there are too many.
  Traffic* traffic_of(const CanFrame& frame) {
    const std::pair key{frame.id, frame.extended};
    const auto known = traffic_.find(key);
    if (known != traffic_.end()) return &known->second;
    if (traffic_.size() == kMostIdentifiers) {
      ++more_;
      return nullptr;
    }
    Traffic& traffic = traffic_[key];
    traffic.first_ns = traffic.last_ns = frame.time_ns;
    traffic.finding.id = frame.id;
    traffic.finding.extended = frame.extended;
    traffic.finding.least_length = frame.length;
    for (const drivers::DbcMessage& message : dbc_.messages) {
      if (message.id != frame.id || message.extended != frame.extended) continue;
      traffic.finding.message = message.name;
      traffic.message = std::make_unique<Message>(dbc_, message);
    }
    return &traffic;
  }

  static void take(const CanFrame& frame, Traffic& traffic) {
    IdentifierFinding& finding = traffic.finding;
    ++finding.frames;
    finding.least_length = std::min(finding.least_length, frame.length);
    finding.most_length = std::max(finding.most_length, frame.length);
    const double pause_s = 1e-9 * static_cast<double>(frame.time_ns - traffic.last_ns);
    finding.longest_pause_s = std::max(finding.longest_pause_s, pause_s);
    traffic.last_ns = frame.time_ns;
    if (traffic.message && !frame.remote) traffic.message->take(frame);
  }

  const drivers::Dbc& dbc_;
  Inspection& found_;
  std::map<std::pair<std::uint32_t, bool>, Traffic> traffic_;
  std::uint64_t more_{0};
  std::uint64_t count_{0};
  std::int64_t first_ns_{0};
  std::int64_t last_ns_{0};
};

/// To the end; of a pipe, to a signal.
template <class Source>
void read_all(Source& source, const std::string& path, Survey& survey) {
  PipeEnd end{path};
  std::array<CanFrame, kFrameBatch> frames;
  for (;;) {
    const auto count = source.read(frames);
    if (!count.ok() && count.error() != Errc::kEndOfStream) throw RunError{source.error_text()};
    if (!count.ok()) return;
    if (count.value() == 0) static_cast<void>(source.wait(kPatience));
    const auto batch = std::span<const CanFrame>{frames}.first(count.value());
    survey.take(batch);
    if (end.reached(batch.empty())) return;
  }
}

template <class Source>
void describe(const Source& source, Inspection& found) {
  found.malformed = source.health().malformed;
  for (std::size_t i = 0; i < source.interfaces().size(); ++i)
    found.interfaces.emplace_back(source.interfaces().name(i));
}

void read_recording(const InspectOptions& options, Survey& survey, Inspection& found) {
  auto opened = drivers::open_frames({options.source, true, {}});
  if (!opened.ok()) throw RunError{opened.error_text()};
  read_all(*opened.value(), options.source, survey);
  found.clock = opened.value()->clock();
  describe(*opened.value(), found);
  for (std::string& note : opened.value()->notes()) found.notes.push_back(std::move(note));
}

void read_blackbox(const InspectOptions& options, Survey& survey, Inspection& found) {
  auto opened = drivers::BlackboxSource::open({options.source, {}});
  if (!opened.ok()) throw RunError{opened.error_text()};
  read_all(*opened.value(), options.source, survey);
  found.clock = drivers::RecordClock::kUtc;
  describe(*opened.value(), found);
}

void listen(const InspectOptions& options, Survey& survey, Inspection& found) {
  const drivers::SystemClock clock;
  drivers::SocketCanConfig bus;
  bus.interface = options.source;
  bus.run_time = hal::RunTime::start(clock);
  auto opened = drivers::SocketCanSource::open(bus, clock);
  if (!opened.ok()) throw RunError{opened.error_text()};
  const StopRequest stop;
  const std::int64_t end_ns = clock.monotonic_ns() + std::llround(1e9 * options.duration_s);
  std::array<CanFrame, kFrameBatch> frames;
  while (!stop.made() && clock.monotonic_ns() < end_ns) {
    static_cast<void>(opened.value()->wait(kPatience));
    const auto count = opened.value()->read(frames);
    if (count.ok()) survey.take(std::span<const CanFrame>{frames}.first(count.value()));
  }
  found.clock = drivers::RecordClock::kUtc;
  found.interfaces = {options.source};
}

}  // namespace

void inspect_frames(const InspectOptions& options, Inspection& found) {
  const drivers::Dbc dbc = open_dbc(options.dbc);
  Survey survey{dbc, found};
  found.frames = true;
  found.dbc = options.dbc;
  if (found.format == kInterfaceFormat)
    listen(options, survey, found);
  else if (drivers::is_blackbox(options.source))
    read_blackbox(options, survey, found);
  else
    read_recording(options, survey, found);
  survey.conclude();
}

}  // namespace dampline::app
