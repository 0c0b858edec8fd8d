// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

#include "drivers/record/frame_lines.hpp"

namespace dampline::drivers {

/// What a parser of frames' lines makes of one.
struct ParsedLine {
  FrameLineParser::Kind kind{};
  std::string expected;
  std::ptrdiff_t column{-1};  ///< of what was found instead; -1: none is told
  CanFrame frame;
  std::string interface;
};

/// `before`: what the frame holds when the parser gets it.
inline ParsedLine parsed(FrameLineParser& parser, const std::string& line,
                         const CanFrame& before = {}) {
  ParsedLine out;
  out.frame = before;
  std::string_view interface;
  const auto found = parser.parse(line, out.frame, interface);
  out.kind = found.kind;
  out.expected = found.expected == nullptr ? "" : found.expected;
  if (found.at != nullptr) out.column = found.at - line.data();
  out.interface = interface;
  return out;
}

}  // namespace dampline::drivers
