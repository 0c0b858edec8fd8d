// SPDX-License-Identifier: MIT
#pragma once
#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "dampline/can_frame.hpp"

namespace dampline::drivers {

/// What is wrong with a line that begins like one of candump's, and where.
struct CandumpFault {
  const char* expected{nullptr};  ///< null: nothing
  const char* at{nullptr};        ///< first character that does not fit
};

/// Reads one line of a candump log (can-utils): `(sec.frac) iface ID#DATA`, also `ID##<flags>DATA`
/// for CAN FD, `ID#R` or `ID#R<length>` for a remote request, 6 or 9 decimals, and an optional
/// direction ` R` or ` T`. Three hexadecimal digits are a standard identifier, eight an extended
/// one; an eight- digit one with bit 29 set is an error frame. Sets all of the frame but
/// interface_index, and the interface's name, 1...15 characters. Precondition: the character behind
/// the line can be read and is none of 0-9 a-f A-F; it is \n or \r or 0 in practice.
class CandumpLine {
 public:
  [[nodiscard]] CandumpFault parse(std::string_view line, CanFrame& frame) noexcept;
  [[nodiscard]] std::string_view interface_name() const noexcept { return interface_; }

 private:
  /// Most lines are of the second of the line before: false where this one is not, or is unusual.
  [[nodiscard]] bool take_same_second(std::string_view line, CanFrame& frame) const noexcept;
  void remember_second(std::string_view line, std::int64_t time_ns) noexcept;

  std::string_view interface_;
  std::array<std::uint64_t, 2> second_text_{};  // "(1600000000." as its characters 0-7 and 4-11
  std::int64_t second_ns_{-1};                  // negative: none
};

/// Appends one line as `candump -l` writes it: "(1700000000.000200) can0 310#0A1B2C00\n", also CAN
/// FD, remote requests and error frames. The interface's name is cut at 15 characters and set right
/// in `name_width`, as candump does with several interfaces. Times before 1970 are written as 0.
/// Not kept: the raw length code of a classic frame of 8 bytes.
void append_candump(fmt::memory_buffer& text, const CanFrame& frame,
                    std::string_view interface_name, std::size_t name_width = 0);

}  // namespace dampline::drivers
