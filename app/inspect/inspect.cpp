// SPDX-License-Identifier: MIT
#include "app/inspect/inspect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "app/config/columns.hpp"
#include "app/error.hpp"
#include "app/inspect/parts.hpp"
#include "app/record/frames.hpp"
#include "app/record/source_kind.hpp"
#include "app/text/format.hpp"
#include "drivers/record/format.hpp"

namespace dampline::app {
namespace {

constexpr double kLeastRateHz = 150.0;  // of a truck's frames: Estimator, and the decimator's bound
constexpr double kMostRateHz = 400.0;

using SignalList = std::vector<const SignalFinding*>;

/// "..._Z", "AZ", "VERT": of a sensor with three axes the one that counts.
bool is_vertical(const SignalFinding& signal) {
  std::string name = signal.name.substr(signal.name.find('.') + 1);
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name.ends_with('z') || name.find("_z_") != std::string::npos ||
         name.find("vert") != std::string::npos;
}

/// Accelerations of a usable rate; the vertical ones, where names tell of any.
SignalList accelerations(const Inspection& found) {
  SignalList all;
  for (const IdentifierFinding& identifier : found.identifiers)
    for (const SignalFinding& signal : identifier.signals)
      if (signal.acceleration && signal.values.moves()) all.push_back(&signal);
  SignalList vertical = all;
  std::erase_if(vertical, [](const SignalFinding* s) { return !is_vertical(*s); });
  return vertical.size() >= kChannels ? vertical : all;
}

SignalList of_column(const SignalList& all, Column column) {
  SignalList out;
  for (const SignalFinding* signal : all) {
    std::string words = signal->name;
    std::replace(words.begin(), words.end(), '.', ' ');
    if (truck_column(words, signal->unit) == column) out.push_back(signal);
  }
  return out;
}

void find_by_rms(SignalList three, Inspection& found) {
  const auto rms = [](const SignalFinding* s) { return s->in_mps2 * s->values.rms(); };
  const auto frame = std::min_element(three.begin(), three.end(),
                                      [&](auto* a, auto* b) { return rms(a) < rms(b); });
  std::rotate(three.begin(), frame, frame + 1);
  std::sort(three.begin() + 1, three.end(), [](auto* a, auto* b) { return a->name < b->name; });
  for (std::size_t c = 0; c < kChannels; ++c)
    found.truck[c] = Candidate{three[c]->name, c == 0 ? "by its rms, the least of three: check it"
                                                      : "what is left: check it"};
}

const SignalFinding* signal_of(const Inspection& found, const std::string& name) {
  for (const IdentifierFinding& identifier : found.identifiers)
    for (const SignalFinding& signal : identifier.signals)
      if (signal.name == name) return &signal;
  return nullptr;
}

void propose_configuration(Inspection& found) {
  for (const auto& candidate : found.truck)
    if (!candidate) return;
  const double rate_hz = signal_of(found, found.truck[0]->name)->rate_hz;
  if (!(rate_hz >= kLeastRateHz && rate_hz <= kMostRateHz)) {
    found.notes.push_back(
        fmt::format("{} comes at {:.6g} Hz; a truck is identified at {} to {} Hz.",
                    found.truck[0]->name, rate_hz, kLeastRateHz, kMostRateHz));
    return;
  }
  const double round_hz = std::round(rate_hz);
  const double nominal_hz = std::fabs(rate_hz - round_hz) < 1e-3 * round_hz ? round_hz : rate_hz;
  found.configuration =
      fmt::format("{}\n[input]\nsample_rate_hz = {:.3f}\n\n[input.can]\n", kMassLines, nominal_hz);
  if (!found.dbc.empty()) found.configuration += fmt::format("dbc = {}\n", toml_string(found.dbc));
  for (std::size_t c = 0; c < kChannels; ++c)
    found.configuration +=
        fmt::format("{}_accel = {}\n", kTruckChannels[c], toml_string(found.truck[c]->name));
}

void explain_no_truck(Inspection& found) {
  const bool decoded = std::any_of(found.identifiers.begin(), found.identifiers.end(),
                                   [](const IdentifierFinding& i) { return !i.signals.empty(); });
  if (!decoded && !found.identifiers.empty())
    found.notes.push_back(found.dbc.empty()
                              ? "The project's own DBC file has none of these identifiers: --dbc "
                                "FILE names the one of the sensors."
                              : fmt::format("{} has none of these identifiers.", found.dbc));
  else if (decoded && !found.truck[0])
    found.notes.emplace_back(
        "Which signals stand on the frame and the wheelsets is not clear from names or rms; [input."
        "can] frame_accel, wheelset1_accel and wheelset2_accel say it.");
}

}  // namespace

void find_truck(Inspection& found) {
  const SignalList all = accelerations(found);
  bool by_name = true;
  for (std::size_t c = 0; c < kChannels; ++c) {
    const SignalList fitting = of_column(all, kTruckColumns[c]);
    by_name = by_name && fitting.size() == 1;
    if (fitting.size() == 1) found.truck[c] = Candidate{fitting.front()->name, "by its name"};
  }
  const auto same_rate = [&](const SignalFinding* s) {
    return std::fabs(s->rate_hz - all.front()->rate_hz) < 0.01 * all.front()->rate_hz;
  };
  if (!by_name && all.size() == kChannels && std::all_of(all.begin(), all.end(), same_rate))
    find_by_rms(all, found);
}

Inspection inspect(const InspectOptions& options) {
  Inspection found;
  found.source = options.source;
  const SourceOptions source{options.source, true};
  const std::optional<SourceKind> frames = detect_frames(source);
  if (!frames && !options.dbc.empty())
    throw UsageError{fmt::format("--dbc: {} holds columns, no frames", options.source)};
  if (frames == SourceKind::kInterface) {
    found.format = kInterfaceFormat;
  } else if (frames == SourceKind::kBlackbox) {
    found.format = "a black box";
  } else if (const auto format = drivers::detect_format(options.source); format.ok()) {
    found.format = name_of(format.value());
  }
  if (!frames) {
    inspect_rows(options, found);
    return found;
  }
  inspect_frames(options, found);
  find_truck(found);
  propose_configuration(found);
  explain_no_truck(found);
  return found;
}

}  // namespace dampline::app
