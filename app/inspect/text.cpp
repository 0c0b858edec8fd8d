// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "app/inspect/inspect.hpp"
#include "app/record/frames.hpp"
#include "app/run/json.hpp"
#include "app/run/provenance.hpp"
#include "app/text/format.hpp"

namespace dampline::app {
namespace {

constexpr std::size_t kListed = 40;  // on a terminal

std::string start_text(double start_s) { return utc_text(std::llround(1e9 * start_s)); }

std::string identifier_text(const IdentifierFinding& found) {
  return fmt::format("0x{:X}{}", found.id, found.extended ? " extended" : "");
}

std::string length_text(const IdentifierFinding& found) {
  return found.least_length == found.most_length
             ? fmt::format("{}", found.most_length)
             : fmt::format("{} to {}", found.least_length, found.most_length);
}

std::string values_text(const SignalFinding& signal) {
  const Values& values = signal.values;
  if (values.count() == 0) return "no number";
  if (!values.moves()) return fmt::format("{:.6g} all the time", values.least());
  return fmt::format("rms {:.4g} about {:.4g}, from {:.5g} to {:.5g}, resolution {:.3g}",
                     values.rms(), values.mean(), values.least(), values.most(),
                     signal.resolution.value_or(values.step()));
}

std::string unit_text(const SignalFinding& signal) {
  return signal.unit.empty() ? "" : fmt::format(" [{}]", signal.unit);
}

void append_identifiers(const Inspection& found, std::string& text) {
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "  {:<19} {:>9} {:>8} {:>10}  {}\n", "identifier", "rate/Hz", "length",
                 "frames", "message");
  std::size_t shown = 0;
  for (const IdentifierFinding& each : found.identifiers) {
    if (shown++ == kListed) {
      fmt::format_to(out, "  and {} more, which --json lists\n",
                     found.identifiers.size() - kListed);
      return;
    }
    fmt::format_to(out, "  {:<19} {:>9.2f} {:>8} {:>10}  {}\n", identifier_text(each), each.rate_hz,
                   length_text(each), each.frames, each.message.empty() ? "-" : each.message);
    for (const SignalFinding& signal : each.signals)
      fmt::format_to(out, "      {}{}: {}\n", signal.name, unit_text(signal), values_text(signal));
  }
}

std::string span_text(const Inspection& found) {
  std::string text = fmt::format("  holds      {:.3f} s, {} {}", found.span_s,
                                 format_count(found.count), found.frames ? "frames" : "rows");
  if (!found.frames && found.rate_hz > 0.0) text += fmt::format(" at {:.6g} Hz", found.rate_hz);
  if (!found.interfaces.empty()) text += fmt::format(" of {}", fmt::join(found.interfaces, ", "));
  if (found.error_frames > 0) text += fmt::format(", {} error frames", found.error_frames);
  if (found.malformed > 0)
    text += fmt::format(", {} malformed {}", found.malformed, found.frames ? "frames" : "lines");
  return text + "\n";
}

std::string gap_text(const Inspection& found) {
  const std::string than = found.frames
                               ? fmt::format("{:g} s between two frames", Inspection::kGapS)
                               : std::string{"1.5 intervals between two rows"};
  if (found.gaps == 0) return fmt::format("  gaps       none of more than {}\n", than);
  return fmt::format("  gaps       {} of more than {}, the longest {:.3f} s\n", found.gaps, than,
                     found.longest_gap_s);
}

std::string clock_text(const Inspection& found) {
  if (!found.start_s) return "  start      not told by its times\n";
  const bool local = found.clock == drivers::RecordClock::kLocal;
  return fmt::format("  start      {}{}\n", start_text(*found.start_s),
                     local ? " by a clock in a time zone that is not told" : "");
}

}  // namespace

std::string inspection_text(const Inspection& found) {
  std::string text = fmt::format("{}: {}\n", found.source, found.format) + clock_text(found) +
                     span_text(found) + gap_text(found);
  const auto out = std::back_inserter(text);
  if (found.frames) append_identifiers(found, text);
  for (const SignalFinding& column : found.columns)
    fmt::format_to(out, "      {}{}: {}\n", column.name,
                   column.name.find(column.unit) == std::string::npos ? unit_text(column) : "",
                   values_text(column));
  for (std::size_t c = 0; c < kChannels; ++c)
    if (found.truck[c])
      fmt::format_to(out, "  {:<10} could be {} ({})\n", kTruckChannels[c], found.truck[c]->name,
                     found.truck[c]->why);
  for (const std::string& note : found.notes) fmt::format_to(out, "  {}\n", note);
  if (!found.configuration.empty())
    fmt::format_to(
        out,
        "\n# car.toml: paste what follows, then `dampline config check car.toml --record "
        "{}`\n{}",
        found.source, found.configuration);
  return text;
}

namespace {

using nlohmann::ordered_json;

ordered_json signal_json(const SignalFinding& signal) {
  ordered_json out{{"name", signal.name},
                   {"unit", signal.unit},
                   {"rate_hz", signal.rate_hz},
                   {"values", signal.values.count()},
                   {"acceleration", signal.acceleration}};
  if (signal.values.count() == 0) return out;
  out["mean"] = signal.values.mean();
  out["rms"] = signal.values.rms();
  out["minimum"] = signal.values.least();
  out["maximum"] = signal.values.most();
  if (signal.resolution) out["resolution"] = *signal.resolution;
  return out;
}

ordered_json identifier_json(const IdentifierFinding& each) {
  ordered_json signals = ordered_json::array();
  for (const SignalFinding& signal : each.signals) signals.push_back(signal_json(signal));
  return {{"id", each.id},
          {"extended", each.extended},
          {"message", each.message},
          {"frames", each.frames},
          {"rate_hz", each.rate_hz},
          {"minimum_length", each.least_length},
          {"maximum_length", each.most_length},
          {"longest_pause_s", each.longest_pause_s},
          {"signals", signals}};
}

}  // namespace

std::string inspection_json(const Inspection& found) {
  ordered_json out{{"source", found.source},
                   {"format", found.format},
                   {"holds", found.frames ? "frames" : "rows"},
                   {"count", found.count},
                   {"span_s", found.span_s}};
  out["start_utc"] = found.start_s && found.clock == drivers::RecordClock::kUtc
                         ? ordered_json(start_text(*found.start_s))
                         : ordered_json(nullptr);
  out["gaps"] = found.gaps;
  out["longest_gap_s"] = found.longest_gap_s;
  out["malformed"] = found.malformed;
  if (found.frames) {
    out["error_frames"] = found.error_frames;
    out["interfaces"] = found.interfaces;
    out["identifiers"] = ordered_json::array();
    for (const IdentifierFinding& each : found.identifiers)
      out["identifiers"].push_back(identifier_json(each));
  } else {
    out["rate_hz"] = found.rate_hz;
    out["columns"] = ordered_json::array();
    for (const SignalFinding& column : found.columns) out["columns"].push_back(signal_json(column));
  }
  out["truck"] = ordered_json::object();
  for (std::size_t c = 0; c < kChannels; ++c)
    if (found.truck[c])
      out["truck"][std::string{kTruckChannels[c]}] = {{"signal", found.truck[c]->name},
                                                      {"why", found.truck[c]->why}};
  out["notes"] = found.notes;
  out["configuration"] = found.configuration;
  return json_text(out);
}

}  // namespace dampline::app
