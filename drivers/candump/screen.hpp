// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/record/frame_lines.hpp"

namespace dampline::drivers {

/// What candump (can-utils) prints on the screen: "(TIME)  can0  RX - -  123   [8]  11 22 ...",
/// with the time of -t a (seconds since 1970), z (since the first frame), d (since the frame
/// before) or A (date and time of day, taken as UTC), or without one; direction and flags with -x;
/// what follows the bytes (-a) is passed over. Without times frames are stamped as `untimed` says.
class CandumpScreen final : public FrameLineParser {
 public:
  CandumpScreen(bool deltas, const std::optional<UntimedFrames>& untimed)
      : deltas_{deltas}, untimed_{untimed} {}
  [[nodiscard]] Found parse(std::string_view line, CanFrame& frame,
                            std::string_view& interface) noexcept override;
  [[nodiscard]] RecordClock clock() const noexcept override { return clock_; }
  [[nodiscard]] std::vector<std::string> notes() const override;

 private:
  [[nodiscard]] Found take_time(std::string_view& rest, CanFrame& frame) noexcept;
  [[nodiscard]] static Found take_content(std::string_view rest, std::string_view length,
                                          CanFrame& frame) noexcept;
  void stamp(CanFrame& frame) noexcept;

  bool deltas_;
  std::optional<UntimedFrames> untimed_;
  RecordClock clock_{RecordClock::kRelative};
  bool stamped_{false};
  std::int64_t last_ns_{0};
  std::int64_t instants_{0};  // of untimed frames
};

/// Whether the times in brackets are those between frames: among a file's first lines one is less
/// than the one before. Of a pipe it waits for them, at most 2 s without a new one.
[[nodiscard]] bool has_time_differences(const std::string& path);

}  // namespace dampline::drivers
