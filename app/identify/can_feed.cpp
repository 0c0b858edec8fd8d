// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cmath>

#include "app/error.hpp"
#include "app/identify/can_channels.hpp"
#include "app/identify/sample_feed.hpp"
#include "drivers/candump/candump_source.hpp"

namespace dampline::app {
namespace {

constexpr std::size_t kBatch = 256;
constexpr std::chrono::milliseconds kPatience{100};

class CanFeed final : public SampleFeed {
 public:
  CanFeed(const Config& config, std::unique_ptr<drivers::CandumpSource> source,
          const AssemblerConfig& assembler)
      : dbc_{config.input.can.dbc},
        source_{std::move(source)},
        wanted_{assembler.channels},
        assembler_{std::make_unique<SampleAssembler>(assembler)} {}

  bool read(std::vector<Sample>& out) override {
    const auto count = source_->read(frames_);
    if (!count.ok() && count.error() != Errc::kEndOfStream) throw RunError{source_->error_text()};
    if (count.ok() && count.value() == 0) static_cast<void>(source_->wait(kPatience));
    for (std::size_t i = 0; count.ok() && i < count.value(); ++i) {
      assembler_->push(frames_[i]);
      take_ready(out);
    }
    if (count.ok()) return true;
    assembler_->flush();
    take_ready(out);
    return false;
  }
  [[nodiscard]] MeasuredRate rate() const override { return assembler_->measured_rate(); }
  [[nodiscard]] ScreenConfig screen() const override {
    ScreenConfig screen;
    for (std::size_t c = 0; c < kChannels; ++c)
      screen.step_mps2[c] = std::fabs(wanted_[c].accel.scale);
    return screen;
  }
  [[nodiscard]] std::uint64_t lines() const override { return source_->line_number(); }
  [[nodiscard]] std::vector<InputFile> extra_inputs() const override {
    if (dbc_.empty()) return {};
    return {describe_input(dbc_, "dbc")};
  }
  [[nodiscard]] std::string explain_emptiness() const override;
  void describe(RunResult& result) const override;

 private:
  void take_ready(std::vector<Sample>& out) {
    Sample sample;
    while (assembler_->pop(sample)) out.push_back(sample);
  }

  std::string dbc_;
  std::unique_ptr<drivers::CandumpSource> source_;
  std::array<ChannelConfig, kChannels> wanted_;
  std::unique_ptr<SampleAssembler> assembler_;
  std::array<CanFrame, kBatch> frames_{};
};

std::string CanFeed::explain_emptiness() const {
  const AssemblerCounts counts = assembler_->counts();
  std::string channels;
  for (std::size_t c = 0; c < kChannels; ++c)
    channels +=
        fmt::format("{}0x{:X}: {}", c == 0 ? "" : ", ", wanted_[c].id, counts.channels[c].readings);
  return fmt::format(
      "of {} frames ({} malformed lines skipped), {} had other identifiers than [input."
      "can] names; readings by identifier {}; {} instants lacked a channel",
      counts.frames, source_->health().malformed, counts.foreign, channels, counts.incomplete);
}

void CanFeed::describe(RunResult& result) const {
  const hal::SourceHealth health = source_->health();
  const AssemblerCounts counts = assembler_->counts();
  result.counts.insert(result.counts.end(), {{"frames", health.frames},
                                             {"frames_foreign", counts.foreign},
                                             {"frames_dropped", health.dropped},
                                             {"frames_reordered", health.reordered},
                                             {"lines_malformed", health.malformed},
                                             {"lines_ignored", health.ignored},
                                             {"incomplete", counts.incomplete},
                                             {"restarts", counts.restarts}});
  if (health.truncated)
    result.warnings.emplace_back(
        "The log was cut off in the middle of its last line; what is before that "
        "line was used.");
  if (health.malformed > 0)
    result.warnings.push_back(
        fmt::format("{} malformed lines were skipped, as asked for.", health.malformed));
}

}  // namespace

std::unique_ptr<SampleFeed> open_can_feed(const Config& config, const SourceOptions& source) {
  const AssemblerConfig assembler = can_channels(config);
  drivers::CandumpConfig candump{source.path, source.skip_bad_lines, {}};
  if (!config.input.can.interface.empty()) candump.interfaces = {config.input.can.interface};
  auto opened = drivers::CandumpSource::open(candump);
  if (!opened.ok()) throw RunError{opened.error_text()};
  return std::make_unique<CanFeed>(config, std::move(opened.value()), assembler);
}

}  // namespace dampline::app
