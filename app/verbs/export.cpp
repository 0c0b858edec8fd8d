// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>
#include <memory>
#include <optional>
#include <string>

#include "app/error.hpp"
#include "app/record/frames.hpp"
#include "app/text/format.hpp"
#include "app/verbs/output.hpp"
#include "app/verbs/verbs.hpp"
#include "drivers/blackbox/source.hpp"
#include "drivers/candump/line.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app {
namespace {

constexpr std::size_t kBatch = 256;
constexpr std::int64_t kSecondNs = 1'000'000'000;

struct ExportOptions {
  std::string blackbox;
  std::string out{"-"};
  std::string events;
  bool force{false};
  bool quiet{false};
};

/// Nanoseconds as seconds, no digit lost.
std::string seconds_text(std::int64_t time_ns) {
  const bool negative = time_ns < 0;
  const std::uint64_t size =
      negative ? 0 - static_cast<std::uint64_t>(time_ns) : static_cast<std::uint64_t>(time_ns);
  return fmt::format("{}{}.{:09}", negative ? "-" : "", size / kSecondNs, size % kSecondNs);
}

void check_files(const ExportOptions& options) {
  if (options.events == "-") throw UsageError{"--events: expected the name of a file"};
  if (options.events.empty() || options.events != options.out) return;
  throw UsageError{fmt::format("{}: named for two outputs, expected a file each", options.out)};
}

/// As candump with several interfaces: the names end in one column.
std::size_t name_width(const drivers::InterfaceTable& interfaces) {
  std::size_t width = 0;
  for (std::size_t i = 0; i < interfaces.size(); ++i)
    width = std::max(width, interfaces.name(i).size());
  return width;
}

void write_events(drivers::BlackboxSource& source, std::optional<TextFile>& file) {
  hal::Event event;
  while (source.next_event(event)) {
    if (!file) continue;
    fmt::format_to(std::back_inserter(file->buffer()), "{},{},{},{}\n", seconds_text(event.time_ns),
                   name_of(event.kind), event.line, event.value);
    file->tick();
  }
}

/// Both, or none.
void close(TextFile& log, std::optional<TextFile>& events) {
  if (events) events->finish();
  log.finish();
  if (events) events->appear();
  try {
    log.appear();
  } catch (const RunError&) {
    if (events) events->withdraw();
    throw;
  }
}

void write_all(drivers::BlackboxSource& source, const ExportOptions& options) {
  TextFile log{options.out, options.force};
  std::optional<TextFile> events;
  if (!options.events.empty()) {
    events.emplace(options.events, options.force);
    events->buffer().append(std::string_view{"time_s,event,line,value\n"});
  }
  const std::size_t width = name_width(source.interfaces());
  std::array<CanFrame, kBatch> frames;
  for (;;) {
    const auto count = source.read(frames);
    if (!count.ok() && count.error() != Errc::kEndOfStream) throw RunError{source.error_text()};
    for (std::size_t i = 0; count.ok() && i < count.value(); ++i) {
      drivers::append_candump(log.buffer(), frames[i],
                              source.interfaces().name(frames[i].interface_index), width);
    }
    log.tick();
    write_events(source, events);
    if (!count.ok()) break;
  }
  close(log, events);
}

void print_summary(const drivers::BlackboxFindings& found, const ExportOptions& options) {
  std::string text =
      fmt::format("export: {} frames and {} events of {} files -> {}\n", found.frames, found.events,
                  found.files, options.out == "-" ? "standard output" : options.out);
  const auto out = std::back_inserter(text);
  if (found.any_frame()) {
    fmt::format_to(out, "export: from {} to {} s\n", seconds_text(found.first_ns),
                   seconds_text(found.newest_ns));
  }
  fmt::format_to(out,
                 "export: {} damaged stretches, {} records missing, {} files torn at the end\n",
                 found.damaged_stretches, found.missing, found.torn_ends);
  if (found.unreadable_files > 0)
    fmt::format_to(out, "export: {} files have no readable header\n", found.unreadable_files);
  if (found.unknown > 0)
    fmt::format_to(out, "export: {} records of kinds that this version does not know\n",
                   found.unknown);
  if (found.runs_moved > 0) {
    fmt::format_to(out,
                   "export: {} runs began before the one before had ended, by the clock; their "
                   "times were moved to that end\n",
                   found.runs_moved);
  }
  tell(drivers::printable(text, true));
}

int export_blackbox(const ExportOptions& options) {
  check_files(options);
  const auto opened = drivers::BlackboxSource::open({options.blackbox, {}});
  if (!opened.ok()) throw RunError{opened.error_text()};
  write_all(*opened.value(), options);
  if (!options.quiet) print_summary(opened.value()->findings(), options);
  return 0;
}

}  // namespace

void add_export_verb(CLI::App& program, std::function<int()>& action) {
  CLI::App* verb = program.add_subcommand("export", "Write a live run's recording as candump text");
  const auto options = std::make_shared<ExportOptions>();
  verb->add_option("BLACKBOX", options->blackbox, "directory of the recording, or one of its files")
      ->required();
  verb->add_option("--out", options->out, "candump log; - is standard output")
      ->capture_default_str();
  verb->add_option("--events", options->events, "table of the events: time_s,event,line,value");
  verb->add_flag("--force", options->force, "replace files that exist");
  verb->add_flag("--quiet", options->quiet, "no summary on standard error");
  verb->callback([options, &action] { action = [options] { return export_blackbox(*options); }; });
}

}  // namespace dampline::app
