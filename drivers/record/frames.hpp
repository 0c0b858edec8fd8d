// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/candump/interface_table.hpp"
#include "drivers/outcome.hpp"
#include "drivers/record/format.hpp"
#include "hal/frame_source.hpp"

namespace dampline::drivers {

/// How frames are stamped in a record without times: each one of this identifier is a period after
/// the one before, the others come with it.
struct UntimedFrames {
  std::uint32_t id{0};
  bool extended{false};
  double period_s{0.0};
};

struct FrameFileConfig {
  std::string path{};                      ///< "-": standard input
  bool skip_bad_lines{false};              ///< count them in health().malformed and go on
  std::vector<std::string> interfaces{};   ///< only these; empty: all
  std::optional<UntimedFrames> untimed{};  ///< none: all at 0 s
};

/// What a recording's times count from.
enum class RecordClock : std::uint8_t {
  kUtc,       ///< 1970, UTC
  kLocal,     ///< 1970, in a time zone that the file does not name
  kRelative,  ///< its own beginning
};

/// CAN frames of a recording, whatever wrote it. In constant memory, whatever its length.
class RecordedFrames : public hal::FrameSource {
 public:
  /// Why read() returned kMalformed or kIo: file, line or offset, what was found, what was
  /// expected.
  [[nodiscard]] const std::string& error_text() const noexcept { return error_; }
  /// Those that frames came from so far; CanFrame::interface_index counts in it.
  [[nodiscard]] const InterfaceTable& interfaces() const noexcept { return interfaces_; }
  /// Of the file, 0...1; none of a pipe.
  [[nodiscard]] virtual std::optional<double> share_read() const noexcept = 0;
  /// Final once the first frame was read.
  [[nodiscard]] virtual RecordClock clock() const noexcept { return RecordClock::kUtc; }
  /// At the end: what a reader of the results must know, a sentence each.
  [[nodiscard]] virtual std::vector<std::string> notes() const { return {}; }

 protected:
  enum class Step : std::uint8_t { kFrame, kNoFrame, kWait, kStop };
  explicit RecordedFrames(const FrameFileConfig& config)
      : skip_bad_lines_{config.skip_bad_lines}, wanted_{config.interfaces} {}
  /// One step further in the record.
  [[nodiscard]] virtual Step read_one(CanFrame& frame) noexcept = 0;
  /// Ends the reading; `text` as error_text().
  Step stop(Errc reason, std::string text) noexcept;
  [[nodiscard]] bool stopped() const noexcept { return stopped_; }
  [[nodiscard]] bool is_wanted(std::string_view interface) const noexcept;

  bool skip_bad_lines_;
  InterfaceTable interfaces_;
  hal::SourceHealth health_{};

 private:
  [[nodiscard]] Result<std::size_t> do_read(std::span<CanFrame> out) noexcept final;
  [[nodiscard]] hal::SourceHealth do_health() const noexcept final { return health_; }

  std::vector<std::string> wanted_;
  std::string error_;
  bool stopped_{false};
  Errc reason_{Errc::kEndOfStream};
};

/// Opens a recording by its content. What is neither of the formats is read as a candump log, which
/// says what it found instead; rows and formats that are not read are refused by name.
[[nodiscard]] Outcome<std::unique_ptr<RecordedFrames>> open_frames(const FrameFileConfig& config);
/// The same where the format is known.
[[nodiscard]] Outcome<std::unique_ptr<RecordedFrames>> open_frames(const FrameFileConfig& config,
                                                                   RecordFormat format);

}  // namespace dampline::drivers
