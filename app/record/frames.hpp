// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/config/config.hpp"
#include "app/run/result.hpp"
#include "dampline/can_frame.hpp"
#include "dampline/sample/assembler.hpp"
#include "dampline/sample/screen.hpp"
#include "drivers/dbc/parse.hpp"
#include "hal/event.hpp"
#include "hal/frame_source.hpp"

namespace dampline::app {

/// Empty: of the project's own sensors. Throws UsageError naming file and line.
[[nodiscard]] drivers::Dbc open_dbc(const std::string& path);

/// MESSAGE.SIGNAL of channel `c`: the configuration's, else the project's own.
[[nodiscard]] std::string can_signal(const InputConfig& input, std::size_t c);

/// The three channels as the DBC file of the configuration describes them; without one, the
/// project's own sensors. Throws UsageError naming file and signal, also where two channels have
/// one signal, and where [input.scale] names a factor: frames have theirs from the DBC file.
[[nodiscard]] AssemblerConfig can_channels(const Config& config);

/// What the channels' signals tell the screen beforehand: their resolution.
[[nodiscard]] ScreenConfig screen_of(const std::array<ChannelConfig, kChannels>& channels);

/// Adds what became of the frames: frames_sent = frames_processed + frames_dropped +
/// frames_missing + frames_excluded, and the parts of the last; warnings where input was cut off or
/// skipped.
void describe_frames(const hal::SourceHealth& health, const AssemblerCounts& counts,
                     RunResult& result);

/// How often each identifier came, among the first kMost frames.
class IdentifierCounts {
 public:
  static constexpr std::uint64_t kMost = 100'000;
  void take(std::span<const CanFrame> frames);
  /// "0x310 (300), 0x18FF1234 extended (12)": those that came most often, and how many more there
  /// are; empty: no frame came.
  [[nodiscard]] std::string busiest() const;

 private:
  using Identifier = std::pair<std::uint32_t, bool>;  // the latter: extended
  std::map<Identifier, std::uint64_t> counts_;
  std::uint64_t taken_{0};
};

/// For an error message when not one sample came: what there was instead.
[[nodiscard]] std::string explain_no_sample(const hal::SourceHealth& health,
                                            const AssemblerCounts& counts,
                                            const std::array<ChannelConfig, kChannels>& channels);

/// "link_down", "marker_on", ...
[[nodiscard]] std::string_view name_of(hal::EventKind kind) noexcept;

/// The first kMost events of a run; later ones are counted.
class EventList {
 public:
  static constexpr std::size_t kMost = 10000;
  void add(const hal::Event& event) {
    if (events_.size() < kMost) {
      events_.push_back(event);
    } else {
      ++more_;
    }
  }
  /// With times from the run's first sample, in the order of time.
  void describe(std::int64_t first_time_ns, RunResult& result) const;

 private:
  std::vector<hal::Event> events_;
  std::uint64_t more_{0};
};

}  // namespace dampline::app
