// SPDX-License-Identifier: MIT
#include "app/identify/source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>

#include "app/beside.hpp"
#include "app/error.hpp"
#include "app/identify/low_pass.hpp"
#include "app/record/source_kind.hpp"
#include "app/rig/identify.hpp"
#include "app/rig/record.hpp"
#include "app/rig/result.hpp"
#include "app/text/format.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app {

namespace {

constexpr std::chrono::milliseconds kInterval{200};

}  // namespace

Progress::Progress(bool enabled)
    : enabled_{enabled}, start_{std::chrono::steady_clock::now()}, next_{start_ + kInterval} {}

bool Progress::due() {
  if (!enabled_) return false;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return false;
  next_ = now + kInterval;
  return true;
}

void Progress::show(std::optional<double> share, double time_s, const std::string& state) {
  if (!enabled_) return;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
  const std::string percent =
      share ? fmt::format("{:3.0f} %  ", std::min(99.0, 100.0 * *share)) : std::string{};
  const std::string speed = time_s > 0.0
                                ? fmt::format("{:.0f} s of record, {:.0f} x real time  ", time_s,
                                              time_s / std::max(elapsed.count(), 1e-9))
                                : std::string{};
  tell(fmt::format("\r\033[K{}{}{}", percent, speed, drivers::printable(state)));
  shown_ = true;
}

void Progress::clear() {
  if (shown_) tell("\r\033[K");
  shown_ = false;
}

PipeEnd::PipeEnd(const std::string& path) {
  std::error_code error;
  const auto type = std::filesystem::status(path, error).type();
  if (path == "-" || type == std::filesystem::file_type::fifo ||
      type == std::filesystem::file_type::character)
    stop_.emplace();
}

bool PipeEnd::reached(bool empty) noexcept {
  constexpr int kMostBatches = 4096;  // of a writer that goes on in spite of the signal
  constexpr int kMostEmpty = 5;       // each was waited for
  if (!by_signal()) return false;
  empty_ = empty ? empty_ + 1 : 0;
  return ++batches_ > kMostBatches || empty_ >= kMostEmpty;
}

namespace {

Identified identify_rig_file(const Config& config, const SourceOptions& source,
                             bool show_progress) {
  if (const auto searched = rig::searched_base(config.model); !searched.empty())
    throw UsageError{fmt::format(
        "[model] base: found \"{}\", whose size a search finds; expected `dampline identify` or "
        "`dampline explain` of this record alone",
        searched.front())};
  Progress progress{show_progress};
  Identified out;
  const rig::Record record = rig::csv_record(source.path, config.input, source.skip_bad_lines);
  out.result = rig::identify(record, config, [&](double share) {
    if (progress.due()) progress.show(share, 0.0, "");
  });
  return out;
}

}  // namespace

Identified identify_truck(const Config& config, const SourceOptions& source, SourceKind kind,
                          bool show_progress, double most_s) {
  static_cast<void>(estimator_config(config));  // wrong settings before a wrong source
  const auto feed = open_feed(config, source, kind);
  TruckRun<kIdentifyParts> run{config, feed->signals()};
  pump(*feed, source, show_progress, run, most_s);
  Identified out;
  out.result = run.finish(rate_of(*feed, run), source.path);
  feed->describe(run.frames(), out.result);
  out.inputs = feed->extra_inputs();
  out.sums = run.statistics();
  return out;
}

std::unique_ptr<SampleFeed> open_feed(const Config& config, const SourceOptions& source,
                                      SourceKind kind) {
  if (kind == SourceKind::kFrames) return open_can_feed(config, source);
  if (kind == SourceKind::kBlackbox) return open_blackbox_feed(config, source);
  return open_csv_feed(config, source);
}

Identified identify_source(const Config& config, const SourceOptions& source, SourceKind kind,
                           bool show_progress) {
  // Beside the identification, so that a checksum costs no time; of a pipe after it.
  const bool is_file = std::filesystem::is_regular_file(source.path);
  auto record = is_file ? beside(describe_record, source.path)
                        : std::async(std::launch::deferred, describe_record, source.path);
  Identified out = kind == SourceKind::kRigRows
                       ? identify_rig_file(config, source, show_progress)
                       : identify_truck(config, source, kind, show_progress);
  const bool can_be_read_again = is_file || kind == SourceKind::kBlackbox;
  if (can_be_read_again && kind != SourceKind::kRigRows)
    look_for_low_pass(config, source, out.result);
  out.inputs.insert(out.inputs.begin(), record.get());
  return out;
}

}  // namespace dampline::app
