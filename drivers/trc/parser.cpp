// SPDX-License-Identifier: MIT
#include "drivers/trc/parser.hpp"

#include <algorithm>

#include "drivers/record/identifier.hpp"
#include "drivers/text/cursor.hpp"

namespace dampline::drivers {
namespace {

constexpr std::uint32_t kMostBuses = 255;

struct Version {
  std::string_view name;
  std::string_view columns;
};
/// As $COLUMNS of 2.1 names them: number, time, type, bus, identifier, direction, reserved, data
/// length, code of the data length, data. In 1.x the type is the direction.
constexpr std::array kVersions{Version{"1.0", "NOILD"},   Version{"1.1", "NOTILD"},
                               Version{"1.2", "NOBTILD"}, Version{"1.3", "NOBTIRLD"},
                               Version{"2.0", "NOTIdlD"}, Version{"2.1", "NOTBIdRLD"}};

}  // namespace

void TrcParser::take_version(std::string_view version) noexcept {
  for (const Version& known : kVersions) {
    if (version != known.name) continue;
    columns_.fill('\0');
    std::copy(known.columns.begin(), known.columns.end(), columns_.begin());
    return;
  }
  refusal_ = "a TRC version that is not read, expected 1.0, 1.1, 1.2, 1.3, 2.0 or 2.1";
}

void TrcParser::take_comment(std::string_view line) noexcept {
  constexpr std::string_view kVersion = ";$FILEVERSION=";
  constexpr std::string_view kColumns = ";$COLUMNS=";
  while (!line.empty() && line.back() == ' ') line.remove_suffix(1);
  if (line.starts_with(kVersion)) return take_version(line.substr(kVersion.size()));
  if (!line.starts_with(kColumns)) return;
  columns_.fill('\0');
  std::size_t count = 0;
  for (const char c : line.substr(kColumns.size()))
    if (c != ',' && c != ' ' && count + 1 < columns_.size()) columns_[count++] = c;
}

FrameLineParser::Found TrcParser::take_type(std::string_view type, CanFrame& frame) noexcept {
  frame.fd = type == "FD" || type == "FB" || type == "FE" || type == "BI";
  frame.fd_flags = static_cast<std::uint8_t>((type == "FB" || type == "BI" ? 1U : 0U) |
                                             (type == "FE" || type == "BI" ? 2U : 0U));
  frame.remote = type == "RR";
  frame.error = type == "ER";
  passed_over_ =
      !frame.fd && !frame.remote && !frame.error && type != "DT" && type != "Rx" && type != "Tx";
  return FrameLineParser::frame();
}

FrameLineParser::Found TrcParser::take_field(char column, std::string_view word,
                                             CanFrame& frame) noexcept {
  switch (column) {
    case 'O': {
      const auto pico = read_nano(word);  // 10^9 a ms
      if (!pico) return bad("a time in ms", word);
      frame.time_ns = *pico / 1000;
      return FrameLineParser::frame();
    }
    case 'T':
      return take_type(word, frame);
    case 'B': {
      const auto bus = read_whole_number(word, 10);
      if (!bus || *bus == 0 || *bus > kMostBuses) return bad("a bus from 1 on", word);
      bus_ = *bus;
      return FrameLineParser::frame();
    }
    case 'I': {
      if (passed_over_) return FrameLineParser::frame();
      const auto id = read_whole_number(word, 16);
      frame.extended = word.size() > 4;
      if (id && *id == 0xFFFFFFFFU)
        passed_over_ = true;  // 1.0: what the bus itself says
      else if (!frame.error && (!id || *id > (frame.extended ? kExtendedMask : kStandardMask)))
        return bad("an identifier of 11 or 29 bits", word);
      frame.id = id.value_or(0);
      return FrameLineParser::frame();
    }
    case 'l':
    case 'L': {
      const auto length = read_whole_number(word, 10);
      if (!length || *length > frame.data.size() || (column == 'L' && *length > 15))
        return passed_over_ ? FrameLineParser::frame() : bad("a data length", word);
      length_ = column == 'l' || *length <= 8 ? *length : frame.fd ? length_of_code(*length) : 8;
      return FrameLineParser::frame();
    }
    default:
      return FrameLineParser::frame();
  }
}

FrameLineParser::Found TrcParser::take_data(std::string_view rest, CanFrame& frame) noexcept {
  std::string_view ahead = rest;
  if (take_word(ahead) == "RTR") frame.remote = true;
  frame.length = static_cast<std::uint8_t>(length_);
  if (frame.remote || frame.error) return FrameLineParser::frame();
  if (const char* at = take_bytes(rest, length_, 16, frame); at != nullptr)
    return {Kind::kBad, "a byte for each of the data length", at};
  return FrameLineParser::frame();
}

FrameLineParser::Found TrcParser::parse(std::string_view line, CanFrame& frame,
                                        std::string_view& interface) noexcept {
  if (line.starts_with(';')) take_comment(line);
  std::string_view rest = line;
  std::string_view ahead = rest;
  if (line.starts_with(';') || take_word(ahead).empty()) return no_frame();
  length_ = 0;
  bus_ = 1;
  passed_over_ = false;
  for (const char column : columns_) {
    if (column == '\0') break;
    const Found found =
        column == 'D' ? take_data(rest, frame) : take_field(column, take_word(rest), frame);
    if (found.kind != Kind::kFrame) return found;
    if (passed_over_) return no_frame();
  }
  interface = name_.set(bus_);
  return FrameLineParser::frame();
}

}  // namespace dampline::drivers
