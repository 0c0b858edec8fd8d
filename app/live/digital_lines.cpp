// SPDX-License-Identifier: MIT
#include "app/live/digital_lines.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <string_view>
#include <utility>
#include <vector>

#include "app/error.hpp"
#include "app/live/status.hpp"
#include "drivers/gpiod/lines.hpp"

namespace dampline::app {

EdgeEvents::EdgeEvents(const std::vector<LineKind>& kinds) {
  lines_.reserve(kinds.size());
  for (const LineKind kind : kinds) lines_.push_back({.kind = kind});
}

std::span<const hal::Event> EdgeEvents::take(const hal::Edge& edge) noexcept {
  used_ = 0;
  if (edge.line >= lines_.size()) return {};
  if (edge.lost_before > 0) {
    counts_.lost += edge.lost_before;
    add(edge, hal::EventKind::kEdgesLost, edge.lost_before);
  }
  if (edge.impossible) {
    ++counts_.impossible;
    add(edge, hal::EventKind::kImpossibleEdge, edge.rising ? 1 : -1);
  }
  add_meaning(lines_[edge.line], edge);
  return {events_.data(), used_};
}

void EdgeEvents::add(const hal::Edge& edge, hal::EventKind kind, std::int64_t value) noexcept {
  events_[used_] = {.time_ns = edge.time_ns, .kind = kind, .line = edge.line, .value = value};
  ++used_;
}

void EdgeEvents::add_meaning(Line& line, const hal::Edge& edge) noexcept {
  if (line.kind == LineKind::kMarker) {
    ++counts_.markers;
    add(edge, edge.rising ? hal::EventKind::kMarkerOn : hal::EventKind::kMarkerOff, 0);
    return;
  }
  if (!edge.rising) return;  // the end of a pulse tells nothing
  if (line.kind == LineKind::kWheel) {
    ++counts_.wheel_pulses;
    add(edge, hal::EventKind::kWheelPulse, 0);
    return;
  }
  ++counts_.pulses;
  judge_pulse(line, edge);
  add(edge, hal::EventKind::kPulse, 0);
}

void EdgeEvents::judge_pulse(Line& line, const hal::Edge& edge) noexcept {
  constexpr std::int64_t kSecondNs = 1'000'000'000;
  const std::int64_t error_ns = edge.time_ns - line.pulse_ns - kSecondNs;
  if (line.pulsed && std::abs(error_ns) > kPulseToleranceNs) ++counts_.implausible;
  line.pulsed = true;
  line.pulse_ns = edge.time_ns;
}

StatusLamp::StatusLamp(std::unique_ptr<hal::DigitalOutput> output) noexcept
    : output_{std::move(output)} {}

StatusLamp::~StatusLamp() {
  if (output_ && lit_ != false) static_cast<void>(output_->set(false));
}

void StatusLamp::show(LampState state, std::int64_t monotonic_ns) noexcept {
  constexpr std::int64_t kRetryNs = 1'000'000'000;
  const bool wanted = lamp_lit(state, monotonic_ns);
  if (!output_ || lit_ == wanted) return;
  if (failures_ > 0 && !lit_ && monotonic_ns < retry_ns_) return;
  if (output_->set(wanted).ok()) {
    lit_ = wanted;
    return;
  }
  lit_.reset();
  ++failures_;
  retry_ns_ = monotonic_ns + kRetryNs;
}

namespace {

constexpr std::chrono::milliseconds kEdgePatience{200};
constexpr std::string_view kEdgeForm = "pulse:LINE, marker:LINE or wheel:LINE, with :active_low";
constexpr std::string_view kLampForm = "LINE or LINE:active_low";

std::string_view next_part(std::string_view& text) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::string_view part = text.substr(0, colon);
  text.remove_prefix(std::min(colon + 1, text.size()));
  return part;
}

/// LINE or LINE:active_low. False when it is neither.
bool read_line(std::string_view text, LineSetting& setting) {
  const std::string_view number = next_part(text);
  const auto [end, error] =
      std::from_chars(number.data(), number.data() + number.size(), setting.offset);
  if (error != std::errc{} || end != number.data() + number.size()) return false;
  setting.active_low = text == "active_low";
  return text.empty() || setting.active_low;
}

[[noreturn]] void fail(std::string_view key, const std::string& text, std::string_view expected) {
  throw UsageError{fmt::format("[gpio] {}: found \"{}\", expected {}", key, text, expected)};
}

LampState lamp_state(LiveState state) noexcept {
  switch (state) {
    case LiveState::kIdentifying:
      return LampState::kIdentifying;
    case LiveState::kWaiting:
    case LiveState::kDegraded:
      return LampState::kDegraded;
    case LiveState::kFault:
      return LampState::kFault;
  }
  return LampState::kOff;
}

}  // namespace

LineSetting parse_edge_line(const std::string& text) {
  constexpr std::array<std::pair<std::string_view, LineKind>, 3> kKinds{
      {{"pulse", LineKind::kPulsePerSecond},
       {"marker", LineKind::kMarker},
       {"wheel", LineKind::kWheel}}};
  std::string_view rest = text;
  const std::string_view word = next_part(rest);
  for (const auto& [name, kind] : kKinds) {
    LineSetting setting;
    setting.kind = kind;
    if (word == name && read_line(rest, setting)) return setting;
  }
  fail("edges", text, kEdgeForm);
}

LineSetting parse_lamp_line(const std::string& text) {
  LineSetting setting;
  if (!read_line(text, setting)) fail("lamp", text, kLampForm);
  return setting;
}

DigitalLines::DigitalLines(const GpioConfig& config, const hal::RunTime& run_time) {
  const bool wanted = !config.edges.empty() || !config.lamp.empty();
  if (wanted && config.chip.empty())
    throw UsageError{"[gpio] chip: found none, expected one, since edges or a lamp are named"};
  if (wanted) open_lines(config, run_time);
}

void DigitalLines::open_lines(const GpioConfig& config, const hal::RunTime& run_time) {
  drivers::EdgeConfig wanted;
  wanted.chip = config.chip;
  wanted.run_time = run_time;
  std::vector<LineKind> kinds;
  for (const std::string& text : config.edges) {
    const LineSetting line = parse_edge_line(text);
    // Both edges, of a pulse as well: that they alternate is the only sign of a loss that libgpiod
    // 1 leaves.
    wanted.lines.push_back({line.offset, line.active_low, true, true});
    kinds.push_back(line.kind);
  }
  if (!kinds.empty()) {
    auto opened = drivers::open_edges(wanted);
    if (!opened.ok()) throw RunError{opened.error_text()};
    edges_ = std::move(opened.value());
    events_ = std::make_unique<EdgeEvents>(std::move(kinds));
  }
  if (config.lamp.empty()) return;
  const LineSetting lamp = parse_lamp_line(config.lamp);
  auto opened = drivers::open_output({config.chip, lamp.offset, lamp.active_low});
  if (!opened.ok()) throw RunError{opened.error_text()};
  lamp_ = std::make_unique<StatusLamp>(std::move(opened.value()));
}

void DigitalLines::start(Recorder& recorder) {
  if (edges_) thread_ = std::thread{[this, &recorder] { watch(recorder); }};
}

void DigitalLines::stop() {
  stop_.store(true, std::memory_order_release);
  if (thread_.joinable()) thread_.join();
}

void DigitalLines::show(LiveState state, bool alarm, std::int64_t monotonic_ns) noexcept {
  const LampState own = lamp_state(state);
  const bool well = own == LampState::kIdentifying;
  if (lamp_) lamp_->show(well && alarm ? LampState::kAlarm : own, monotonic_ns);
}

void DigitalLines::describe(RunResult& result) const {
  if (!edges_) return;
  const EdgeCounts& counts = events_->counts();
  result.counts.insert(result.counts.end(), {{"edges", edges_->health().edges},
                                             {"edges_lost", counts.lost},
                                             {"edges_impossible", counts.impossible},
                                             {"pulses_implausible", counts.implausible}});
  if (gone_)
    result.warnings.emplace_back(
        "The GPIO chip could not be read any more: edges are missing from some moment on.");
}

void DigitalLines::watch(Recorder& recorder) {
  std::array<hal::Edge, 64> edges;
  while (!stop_.load(std::memory_order_acquire)) {
    const auto ready = edges_->wait(kEdgePatience);
    if (!ready.ok()) return gone();
    if (!ready.value()) continue;
    const auto count = edges_->read(edges);
    if (!count.ok()) return gone();
    for (std::size_t i = 0; i < count.value(); ++i)
      for (const hal::Event& event : events_->take(edges[i])) recorder.add(event);
  }
}

}  // namespace dampline::app
