// SPDX-License-Identifier: MIT
#include "drivers/candump/screen.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>

#include "drivers/record/identifier.hpp"
#include "drivers/text/cursor.hpp"
#include "hal/clock.hpp"

namespace dampline::drivers {
namespace {

constexpr std::size_t kAbsoluteDigits = 10;  // of seconds since 1970

std::optional<std::int64_t> two_digits(std::string_view text, std::size_t at, std::size_t count) {
  const auto number = read_whole_number(text.substr(at, count), 10);
  if (!number) return std::nullopt;
  return *number;
}

/// "2020-09-13 12:26:40.123456", since 1970.
std::optional<std::int64_t> read_date(std::string_view text) noexcept {
  constexpr std::size_t kDate = 19;
  if (text.size() < kDate || text[4] != '-' || text[7] != '-' || text[13] != ':')
    return std::nullopt;
  const auto year = two_digits(text, 0, 4);
  const auto month = two_digits(text, 5, 2);
  const auto day = two_digits(text, 8, 2);
  const auto hour = two_digits(text, 11, 2);
  const auto minute = two_digits(text, 14, 2);
  const auto second = read_nano(text.substr(17));
  if (!year || !month || !day || !hour || !minute || !second || *year < 1970 || *year > 2200)
    return std::nullopt;
  using namespace std::chrono;
  const year_month_day date{std::chrono::year{static_cast<int>(*year)},
                            std::chrono::month{static_cast<unsigned>(*month)},
                            std::chrono::day{static_cast<unsigned>(*day)}};
  if (!date.ok() || *hour > 23 || *minute > 59 || *second > 61 * hal::kSecondNs)
    return std::nullopt;
  const std::int64_t days = sys_days{date}.time_since_epoch().count();
  return ((days * 24 + *hour) * 60 + *minute) * 60 * hal::kSecondNs + *second;
}

/// What stands in the brackets at a line's beginning; they are taken off. Nothing: there are none.
std::string_view take_brackets(std::string_view& rest) noexcept {
  while (!rest.empty() && rest.front() == ' ') rest.remove_prefix(1);
  const std::size_t end = rest.find(')');
  if (!rest.starts_with('(') || end == std::string_view::npos) return {};
  const std::string_view inside = rest.substr(1, end - 1);
  rest.remove_prefix(end + 1);
  return inside;
}

}  // namespace

FrameLineParser::Found CandumpScreen::take_time(std::string_view& rest, CanFrame& frame) noexcept {
  const std::string_view text = take_brackets(rest);
  if (text.empty()) return no_frame();
  const bool date = text.find('-') != std::string_view::npos;
  const auto time_ns = date ? read_date(text) : read_nano(text);
  if (!time_ns) return bad("seconds, or a date and a time of day", text);
  const bool absolute = text.find('.') >= kAbsoluteDigits;
  clock_ = date ? RecordClock::kLocal : absolute ? RecordClock::kUtc : RecordClock::kRelative;
  const bool add = deltas_ && !date && !absolute;
  frame.time_ns = add ? later(last_ns_, *time_ns) : *time_ns;
  last_ns_ = frame.time_ns;
  return FrameLineParser::frame();
}

FrameLineParser::Found CandumpScreen::take_content(std::string_view rest, std::string_view length,
                                                   CanFrame& frame) noexcept {
  const auto count = read_whole_number(length.substr(1, length.size() - 2), 10);
  if (!count || *count > frame.data.size()) return bad("a length in brackets", length);
  std::string_view ahead = rest;
  if (take_word(ahead) == "remote") {
    frame.remote = true;
    frame.length = static_cast<std::uint8_t>(std::min<std::uint32_t>(*count, 8));
    return FrameLineParser::frame();
  }
  frame.fd = length.size() == 4 && (length[1] == '0' || *count > 8);
  if (const char* at = take_bytes(rest, *count, 16, frame); at != nullptr)
    return {Kind::kBad, "two hexadecimal digits a byte", at};
  return FrameLineParser::frame();
}

FrameLineParser::Found CandumpScreen::parse(std::string_view line, CanFrame& frame,
                                            std::string_view& interface) noexcept {
  std::string_view rest = line;
  const Found time = take_time(rest, frame);
  if (time.kind == Kind::kBad) return time;
  interface = take_word(rest);
  std::string_view id = take_word(rest);
  if (id == "RX" || id == "TX") {  // and two flags: bit rate switched, error state
    frame.fd_flags = take_word(rest) == "B" ? 1 : 0;
    if (take_word(rest) == "E") frame.fd_flags = static_cast<std::uint8_t>(frame.fd_flags | 2U);
    id = take_word(rest);
  }
  const std::string_view length = take_word(rest);
  const bool is_length = length.size() >= 3 && length.front() == '[' && length.back() == ']';
  if (!is_length)
    return time.kind == Kind::kFrame ? bad("a length in brackets", length) : no_frame();
  if (interface.size() > kLongestName) return bad("an interface of 1 to 15 characters", interface);
  const auto number = read_whole_number(id, 16);
  if (!number || (id.size() != 3 && id.size() != 8)) return bad("3 or 8 hexadecimal digits", id);
  frame.error = id.size() == 8 && (*number & kErrorFlag) != 0;
  frame.extended = id.size() == 8 && !frame.error;
  frame.id = frame.error ? *number & ~kErrorFlag : *number;
  if (frame.id > (id.size() == 8 ? kExtendedMask : kStandardMask))
    return bad("an identifier of 11 or 29 bits", id);
  const Found content = take_content(rest, length, frame);
  if (!frame.fd) frame.fd_flags = 0;
  if (content.kind == Kind::kFrame && time.kind != Kind::kFrame) stamp(frame);
  return content;
}

void CandumpScreen::stamp(CanFrame& frame) noexcept {
  if (!untimed_) return;
  if (!frame.remote && !frame.error && frame.id == untimed_->id &&
      frame.extended == untimed_->extended)
    ++instants_;
  stamped_ = true;
  frame.time_ns =
      static_cast<std::int64_t>(static_cast<double>(instants_) * untimed_->period_s * 1e9);
}

std::vector<std::string> CandumpScreen::notes() const {
  if (!stamped_) return {};
  return {fmt::format(
      "The record has no times (candump without -t, -l or -L): its samples were taken as {:.6g} ms "
      "apart, and lost frames show by their counters alone.",
      1e3 * untimed_->period_s)};
}

bool has_time_differences(const std::string& path) {
  constexpr int kLines = 100;
  constexpr std::chrono::seconds kPatience{2};
  auto reader = LineReader::open(path);
  if (!reader) return false;
  std::string_view line;
  std::int64_t last_ns = -1;
  for (int lines = 0; lines < kLines;) {
    const auto status = reader.value().next(line);
    if (status == LineReader::Status::kNothingYet && reader.value().wait(kPatience)) continue;
    if (status != LineReader::Status::kLine) return false;
    ++lines;
    const std::string_view text = take_brackets(line);
    if (text.find('.') >= kAbsoluteDigits) continue;
    const auto time_ns = read_nano(text);
    if (time_ns && *time_ns < last_ns) return true;
    last_ns = time_ns.value_or(last_ns);
  }
  return false;
}

}  // namespace dampline::drivers
