// SPDX-License-Identifier: MIT
#include "drivers/asc/parser.hpp"

#include <algorithm>

#include "drivers/record/identifier.hpp"
#include "drivers/text/cursor.hpp"

namespace dampline::drivers {
namespace {

constexpr std::uint32_t kMostChannels = 255;

bool is_direction(std::string_view word) { return word == "Rx" || word == "Tx" || word == "TxRq"; }

bool begins_with(std::string_view word, std::string_view lower) {
  const auto same = [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; };
  return word.size() >= lower.size() && std::equal(lower.begin(), lower.end(), word.begin(),
                                                   [&](char b, char a) { return same(a, b); });
}

}  // namespace

void AscParser::take_base(std::string_view rest) noexcept {
  base_ = take_word(rest) == "dec" ? 10 : 16;
  if (begins_with(take_word(rest), "timestamps"))
    relative_ = begins_with(take_word(rest), "relative");
}

bool AscParser::channel(std::string_view word, std::string_view& interface) noexcept {
  const auto number = read_whole_number(word, 10);
  if (!number || *number == 0 || *number > kMostChannels) return false;
  interface = name_.set(*number);
  return true;
}

bool AscParser::identifier(std::string_view word, CanFrame& frame) const noexcept {
  frame.extended = word.ends_with('x') || word.ends_with('X');
  if (frame.extended) word.remove_suffix(1);
  const auto number = read_whole_number(word, base_);
  frame.id = number.value_or(0);
  return number && *number <= (frame.extended ? kExtendedMask : kStandardMask);
}

FrameLineParser::Found AscParser::classic(std::string_view rest, CanFrame& frame) const noexcept {
  const std::string_view id = take_word(rest);
  if (begins_with(id, "errorframe")) {
    frame.error = true;
    return FrameLineParser::frame();
  }
  const std::string_view direction = take_word(rest);
  if (!is_direction(direction)) return no_frame();
  const std::string_view kind = take_word(rest);
  if (kind != "d" && kind != "r") return no_frame();
  if (!identifier(id, frame)) return bad("an identifier of 11 or 29 bits", id);
  const std::string_view code = take_word(rest);
  frame.remote = kind == "r";
  const auto length = read_whole_number(code, base_);
  if (!length && !(frame.remote && code.empty())) return bad("a data length", code);
  const std::uint32_t count = std::min<std::uint32_t>(length.value_or(0), 8);
  frame.length = static_cast<std::uint8_t>(count);
  if (frame.remote) return FrameLineParser::frame();
  if (const char* at = take_bytes(rest, count, base_, frame); at != nullptr)
    return {Kind::kBad, "a byte for each of the data length", at};
  return FrameLineParser::frame();
}

// After "CANFD": channel, direction, identifier, perhaps a name, BRS, ESI, DLC, length, data.
FrameLineParser::Found AscParser::fd(std::string_view rest, CanFrame& frame) const noexcept {
  const std::string_view direction = take_word(rest);
  const std::string_view id = take_word(rest);
  if (begins_with(id, "errorframe")) {
    frame.error = true;
    return FrameLineParser::frame();
  }
  if (!is_direction(direction)) return no_frame();
  if (!identifier(id, frame)) return bad("an identifier of 11 or 29 bits", id);
  std::string_view brs = take_word(rest);
  if (brs != "0" && brs != "1") brs = take_word(rest);  // a name stood there
  const std::string_view esi = take_word(rest);
  const std::string_view code_word = take_word(rest);
  const std::string_view length_word = take_word(rest);
  const auto code = read_whole_number(code_word, 16);
  const auto length = read_whole_number(length_word, 10);
  if (!code || *code > 15) return bad("a length code of CAN FD, 0 to f", code_word);
  if (!length || *length > frame.data.size())
    return bad("a data length of at most 64", length_word);
  frame.fd = true;
  frame.fd_flags = static_cast<std::uint8_t>((brs == "1" ? 1U : 0U) | (esi == "1" ? 2U : 0U));
  if (*length == 0 && *code > 0) {
    frame.fd = false;
    frame.fd_flags = 0;
    frame.remote = true;
    frame.length = static_cast<std::uint8_t>(std::min<std::uint32_t>(*code, 8));
    return FrameLineParser::frame();
  }
  if (const char* at = take_bytes(rest, *length, base_, frame); at != nullptr)
    return {Kind::kBad, "a byte for each of the data length", at};
  // log2asc -f and some tools write classic frames in these lines, too: their flags say so.
  static_cast<void>(take_word(rest));  // duration
  static_cast<void>(take_word(rest));  // bits
  constexpr std::uint32_t kIsFd = 1U << 12U;
  const auto flags = read_whole_number(take_word(rest), 16);
  if (flags && (*flags & kIsFd) == 0U && *length <= 8 && (*flags & 0x3000U) != 0x3000U &&
      frame.fd_flags == 0)
    frame.fd = false;
  return FrameLineParser::frame();
}

FrameLineParser::Found AscParser::parse(std::string_view line, CanFrame& frame,
                                        std::string_view& interface) noexcept {
  std::string_view rest = line;
  const std::string_view first = take_word(rest);
  if (first == "base") take_base(rest);
  const auto time_ns = read_nano(first);
  if (!time_ns || first.find('.') == std::string_view::npos) return no_frame();
  frame.time_ns = relative_ ? later(last_ns_, *time_ns) : *time_ns;
  last_ns_ = frame.time_ns;
  std::string_view word = take_word(rest);
  const bool is_fd = word == "CANFD";
  if (is_fd) word = take_word(rest);
  if (!channel(word, interface)) return no_frame();
  return is_fd ? fd(rest, frame) : classic(rest, frame);
}

}  // namespace dampline::drivers
