// SPDX-License-Identifier: MIT
#include "drivers/record/frame_lines.hpp"

#include <fmt/format.h>

#include "drivers/text/quote.hpp"

namespace dampline::drivers {

Outcome<std::unique_ptr<RecordedFrames>> FrameLines::open(const FrameFileConfig& config,
                                                          std::unique_ptr<FrameLineParser> parser) {
  Outcome<LineReader> reader = LineReader::open(config.path);
  if (!reader.ok()) return reader.failure();
  return std::unique_ptr<RecordedFrames>{
      new FrameLines{config, std::move(reader.value()), std::move(parser)}};
}

FrameLines::Step FrameLines::read_one(CanFrame& frame) noexcept {
  std::string_view line;
  switch (reader_.next(line)) {
    case LineReader::Status::kLine:
      return take_line(line, frame);
    case LineReader::Status::kTooLong:
      return bad_line(line,
                      {FrameLineParser::Kind::kBad, "a line of a frame's length", line.data()});
    case LineReader::Status::kTail:
      health_.truncated = true;
      return Step::kNoFrame;
    case LineReader::Status::kNothingYet:
      return Step::kWait;
    case LineReader::Status::kEnd:
      return end_of_file();
    case LineReader::Status::kError:
      break;
  }
  return stop(reader_.error(), reader_.error_text());
}

FrameLines::Step FrameLines::take_line(std::string_view line, CanFrame& frame) noexcept {
  frame = {};
  std::string_view interface;
  const FrameLineParser::Found found = parser_->parse(line, frame, interface);
  if (const std::string_view refusal = parser_->refusal(); !refusal.empty())
    return stop(Errc::kMalformed,
                fmt::format("{}:{}: {}", reader_.name(), reader_.line_number(), refusal));
  if (found.kind == FrameLineParser::Kind::kBad) return bad_line(line, found);
  any_frame_ = any_frame_ || found.kind == FrameLineParser::Kind::kFrame;
  if (found.kind == FrameLineParser::Kind::kNoFrame || !is_wanted(interface)) {
    ++health_.ignored;
    return Step::kNoFrame;
  }
  const std::optional<std::uint8_t> index = interfaces_.index_of(interface);
  if (!index)
    return bad_line(line, {FrameLineParser::Kind::kBad, "at most 255 interfaces", line.data()});
  frame.interface_index = *index;
  if (!gate_.pass(frame.time_ns, health_))
    return bad_line(line, {FrameLineParser::Kind::kBad,
                           "a time that does not go back by a second or more", line.data()});
  return Step::kFrame;
}

FrameLines::Step FrameLines::bad_line(std::string_view line,
                                      const FrameLineParser::Found& found) noexcept {
  ++health_.malformed;
  if (skip_bad_lines_) return Step::kNoFrame;
  const bool inside =
      found.at != nullptr && found.at >= line.data() && found.at <= line.data() + line.size();
  const std::size_t column =
      inside ? static_cast<std::size_t>(found.at - line.data()) : line.size();
  return stop(Errc::kMalformed,
              fmt::format("{}:{}:{}: found {}, expected {}", reader_.name(), reader_.line_number(),
                          column + 1, quote(line.substr(column)), found.expected));
}

FrameLines::Step FrameLines::end_of_file() noexcept {
  health_.truncated = health_.truncated || reader_.is_cut_off();
  if (any_frame_) return stop(Errc::kEndOfStream, {});
  return stop(Errc::kMalformed, fmt::format("{}: holds no frame in its {} lines", reader_.name(),
                                            reader_.line_number()));
}

}  // namespace dampline::drivers
