// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/candump/line.hpp"
#include "drivers/record/frames.hpp"
#include "drivers/text/line_reader.hpp"
#include "hal/frame_source.hpp"

namespace dampline::drivers {

/// A candump log as a source of frames (line.hpp has the format). Reads on without waiting and
/// without allocating, in constant memory whatever the length of the log.
///
/// Lines that do not begin with ( are ignored and counted, as can-utils does. A line that begins
/// with ( and is none is an error, or counted with skip_bad_lines. A time that is earlier than the
/// one before by less than a second is held and counted as reordered; by more, the line is bad, and
/// so is a line more than a second ahead of both its neighbours. A last line without its end is
/// dropped and sets truncated. Frames of interfaces that were not asked for count as ignored.
class CandumpSource final : public RecordedFrames {
 public:
  static Outcome<std::unique_ptr<CandumpSource>> open(const FrameFileConfig& config);

  [[nodiscard]] std::optional<double> share_read() const noexcept override {
    return reader_.share_read();
  }
  [[nodiscard]] std::uint64_t line_number() const noexcept { return reader_.line_number(); }

 private:
  CandumpSource(const FrameFileConfig& config, LineReader reader);
  [[nodiscard]] Result<bool> do_wait(std::chrono::nanoseconds timeout) noexcept override;

  [[nodiscard]] Step read_one(CanFrame& frame) noexcept override;
  Step take_line(std::string_view line, CanFrame& frame) noexcept;
  void remember_first(std::string_view line) noexcept;
  Step ignore_line(std::string_view line) noexcept;
  Step bad_line(std::string_view line, const CandumpFault& fault) noexcept;
  Step end_of_file() noexcept;
  [[nodiscard]] CandumpFault check_time(std::string_view line, CanFrame& frame) noexcept;
  [[nodiscard]] bool next_goes_back(std::int64_t time_ns) noexcept;
  [[nodiscard]] std::string wrong_kind() const;

  LineReader reader_;
  CandumpLine parser_;
  bool recognised_{false};  // a line of candump's was seen
  bool any_frame_{false};
  std::int64_t newest_ns_{0};
  std::string first_line_;  // to say what a file is that is no candump log
};

}  // namespace dampline::drivers
