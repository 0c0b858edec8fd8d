// SPDX-License-Identifier: MIT
#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <utility>

#include "app/error.hpp"
#include "app/record/feed.hpp"
#include "app/record/frames.hpp"
#include "drivers/blackbox/source.hpp"
#include "drivers/record/frames.hpp"

namespace dampline::app {

namespace {

constexpr std::size_t kFrameBatch = 256;
constexpr std::chrono::milliseconds kPatience{100};

/// `Source` is a hal::FrameSource that explains its errors.
template <class Source>
class CanFeed final : public SampleFeed {
 public:
  CanFeed(const Config& config, std::unique_ptr<Source> source, const AssemblerConfig& assembler)
      : dbc_{config.input.can.dbc},
        source_{std::move(source)},
        wanted_{assembler.channels},
        extras_{assembler.extras} {}

  Batch read() override {
    const auto count = source_->read(frames_);
    if (!count.ok() && count.error() != Errc::kEndOfStream) throw RunError{source_->error_text()};
    if (count.ok() && count.value() == 0) static_cast<void>(source_->wait(kPatience));
    hal::Event event;
    while (source_->next_event(event)) events_.add(event);
    if (!count.ok()) return {.more = false};
    identifiers_.take(std::span{frames_}.first(count.value()));
    return {.frames = std::span{frames_}.first(count.value())};
  }
  [[nodiscard]] RecordSignals signals() const override {
    return {wanted_, screen_of(wanted_), extras_};
  }
  [[nodiscard]] std::optional<double> share_read() const override {
    if constexpr (requires { source_->share_read(); }) return source_->share_read();
    return std::nullopt;
  }
  [[nodiscard]] std::vector<InputFile> extra_inputs() const override {
    if (dbc_.empty()) return {};
    return {describe_input(dbc_, "dbc")};
  }
  [[nodiscard]] std::string explain_emptiness(const FrameSummary& frames) const override {
    const std::string busiest = identifiers_.busiest();
    return explain_no_sample(source_->health(), frames.counts, wanted_) +
           (busiest.empty() ? "" : "; the busiest identifiers of the record: " + busiest);
  }
  void describe(const FrameSummary& frames, RunResult& result) const override {
    describe_frames(source_->health(), frames.counts, result);
    if constexpr (requires { source_->notes(); })
      for (std::string& note : source_->notes()) result.notes.push_back(std::move(note));
    events_.describe(frames.first_time_ns, result);
  }

 private:
  std::string dbc_;
  std::unique_ptr<Source> source_;
  std::array<ChannelConfig, kChannels> wanted_;
  ExtraSignals extras_;
  std::array<CanFrame, kFrameBatch> frames_{};
  EventList events_;
  IdentifierCounts identifiers_;
};

}  // namespace

std::unique_ptr<SampleFeed> open_can_feed(const Config& config, const SourceOptions& source) {
  const AssemblerConfig assembler = can_channels(config);
  drivers::FrameFileConfig file{.path = source.path, .skip_bad_lines = source.skip_bad_lines};
  if (!config.input.can.interface.empty()) file.interfaces = {config.input.can.interface};
  const ChannelConfig& frame = assembler.channels[0];
  file.untimed = {frame.id, frame.extended, 1.0 / assembler.sample_rate_hz};
  auto opened = drivers::open_frames(file);
  if (!opened.ok()) throw RunError{opened.error_text()};
  return std::make_unique<CanFeed<drivers::RecordedFrames>>(config, std::move(opened.value()),
                                                            assembler);
}

std::unique_ptr<SampleFeed> open_blackbox_feed(const Config& config, const SourceOptions& source) {
  const AssemblerConfig assembler = can_channels(config);
  drivers::BlackboxSourceConfig blackbox{source.path, {}};
  if (!config.input.can.interface.empty()) blackbox.interfaces = {config.input.can.interface};
  auto opened = drivers::BlackboxSource::open(blackbox);
  if (!opened.ok()) throw RunError{opened.error_text()};
  return std::make_unique<CanFeed<drivers::BlackboxSource>>(config, std::move(opened.value()),
                                                            assembler);
}

}  // namespace dampline::app
