// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "drivers/record/frame_lines.hpp"
#include "drivers/record/identifier.hpp"

namespace dampline::drivers {

/// PEAK's TRC, versions 1.0, 1.1, 1.2, 1.3, 2.0 and 2.1 (PCAN-View, PCAN-Explorer, python-can).
/// Times are ms from the begin: whole ones in 1.0, tenths in 1.1, 1.2 and 1.3, thousandths in 2.x
/// as far as they are written. Buses become "can1", "can2", ... Warnings, bus errors and statistics
/// are passed over; error frames of 2.x are delivered as such.
class TrcParser final : public FrameLineParser {
 public:
  [[nodiscard]] Found parse(std::string_view line, CanFrame& frame,
                            std::string_view& interface) noexcept override;
  [[nodiscard]] std::string_view refusal() const noexcept override { return refusal_; }

 private:
  void take_comment(std::string_view line) noexcept;
  void take_version(std::string_view version) noexcept;
  [[nodiscard]] Found take_field(char column, std::string_view word, CanFrame& frame) noexcept;
  [[nodiscard]] Found take_data(std::string_view rest, CanFrame& frame) noexcept;
  [[nodiscard]] Found take_type(std::string_view type, CanFrame& frame) noexcept;

  std::array<char, 16> columns_{'N', 'O', 'I', 'L', 'D'};  // of version 1.0, which names none
  std::uint32_t length_{0};
  std::uint32_t bus_{1};
  bool passed_over_{false};
  std::string_view refusal_;
  ChannelName name_;
};

}  // namespace dampline::drivers
