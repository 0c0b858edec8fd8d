// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/record/frames.hpp"
#include "drivers/record/time_gate.hpp"
#include "drivers/text/line_reader.hpp"

namespace dampline::drivers {

/// Reads a text format whose frames are one a line. Keeps what headers said.
class FrameLineParser {
 public:
  enum class Kind : std::uint8_t { kFrame, kNoFrame, kBad };
  struct Found {
    Kind kind{Kind::kNoFrame};
    const char* expected{nullptr};  ///< where kBad
    const char* at{nullptr};        ///< first character that does not fit; null: the line's end
  };
  FrameLineParser() = default;
  FrameLineParser(const FrameLineParser&) = delete;
  FrameLineParser& operator=(const FrameLineParser&) = delete;
  virtual ~FrameLineParser() = default;
  /// Sets all of the frame but interface_index, and the interface's name, 1...15 characters, which
  /// lasts as long as the line or the parser. Times may go back.
  [[nodiscard]] virtual Found parse(std::string_view line, CanFrame& frame,
                                    std::string_view& interface) noexcept = 0;
  [[nodiscard]] virtual RecordClock clock() const noexcept { return RecordClock::kRelative; }
  /// As RecordedFrames::notes().
  [[nodiscard]] virtual std::vector<std::string> notes() const { return {}; }
  /// What the first lines ask for that makes the rest unreadable; empty: nothing.
  [[nodiscard]] virtual std::string_view refusal() const noexcept { return {}; }

 protected:
  [[nodiscard]] static Found bad(const char* expected, std::string_view at) noexcept {
    return {Kind::kBad, expected, at.empty() ? nullptr : at.data()};
  }
  [[nodiscard]] static Found frame() noexcept { return {Kind::kFrame, nullptr, nullptr}; }
  [[nodiscard]] static Found no_frame() noexcept { return {}; }
};

/// A text file of frames as a source. What the parser calls no frame is ignored and counted; what
/// it calls bad is an error with file, line and column, or counted with skip_bad_lines. Times: see
/// TimeGate. A last line without its end is dropped and sets truncated. Frames of interfaces that
/// were not asked for count as ignored. read() neither waits nor allocates.
class FrameLines final : public RecordedFrames {
 public:
  static Outcome<std::unique_ptr<RecordedFrames>> open(const FrameFileConfig& config,
                                                       std::unique_ptr<FrameLineParser> parser);
  [[nodiscard]] std::optional<double> share_read() const noexcept override {
    return reader_.share_read();
  }
  [[nodiscard]] RecordClock clock() const noexcept override { return parser_->clock(); }
  [[nodiscard]] std::vector<std::string> notes() const override { return parser_->notes(); }

 private:
  FrameLines(const FrameFileConfig& config, LineReader reader,
             std::unique_ptr<FrameLineParser> parser)
      : RecordedFrames{config}, reader_{std::move(reader)}, parser_{std::move(parser)} {}
  [[nodiscard]] Result<bool> do_wait(std::chrono::nanoseconds timeout) noexcept override {
    return stopped() || reader_.wait(timeout);
  }

  [[nodiscard]] Step read_one(CanFrame& frame) noexcept override;
  Step take_line(std::string_view line, CanFrame& frame) noexcept;
  Step bad_line(std::string_view line, const FrameLineParser::Found& found) noexcept;
  Step end_of_file() noexcept;

  LineReader reader_;
  std::unique_ptr<FrameLineParser> parser_;
  TimeGate gate_;
  bool any_frame_{false};
};

}  // namespace dampline::drivers
