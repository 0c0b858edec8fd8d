// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <string_view>

#include "drivers/record/frame_lines.hpp"
#include "drivers/record/identifier.hpp"

namespace dampline::drivers {

/// Vector's ASC, as CANoe, CANalyzer, can-utils' log2asc and python-can write it: classic frames
/// ("0.000130 1  311  Rx  d 4 E0 CF CE 00"), remote and error frames, CANFD lines with or without a
/// symbolic name; base hex or dec, timestamps absolute or relative. Times are s from the
/// measurement's begin with the decimals the file has, 4 or 6 in most. Channels become "can1",
/// "can2", ... What is no frame (statistics, comments, events of other buses) is passed over.
class AscParser final : public FrameLineParser {
 public:
  [[nodiscard]] Found parse(std::string_view line, CanFrame& frame,
                            std::string_view& interface) noexcept override;

 private:
  void take_base(std::string_view rest) noexcept;
  [[nodiscard]] Found classic(std::string_view rest, CanFrame& frame) const noexcept;
  [[nodiscard]] Found fd(std::string_view rest, CanFrame& frame) const noexcept;
  [[nodiscard]] bool identifier(std::string_view word, CanFrame& frame) const noexcept;
  [[nodiscard]] bool channel(std::string_view word, std::string_view& interface) noexcept;

  int base_{16};
  bool relative_{false};
  std::int64_t last_ns_{0};
  ChannelName name_;
};

}  // namespace dampline::drivers
