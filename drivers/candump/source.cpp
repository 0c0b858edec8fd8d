// SPDX-License-Identifier: MIT
#include "drivers/candump/source.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "drivers/text/kind.hpp"
#include "drivers/text/quote.hpp"
#include "hal/clock.hpp"

namespace dampline::drivers {
namespace {

// A file of another kind is known by so many lines without a frame.
constexpr std::uint64_t kLinesToJudge = 200;
constexpr std::size_t kFirstLine = 256;
constexpr const char* kExample =
    "lines such as \"(1600000000.123456) can0 123#11223344\" (candump -l)";

}  // namespace

Outcome<std::unique_ptr<CandumpSource>> CandumpSource::open(const FrameFileConfig& config) {
  Outcome<LineReader> reader = LineReader::open(config.path);
  if (!reader.ok()) return reader.failure();
  return std::unique_ptr<CandumpSource>{new CandumpSource{config, std::move(reader.value())}};
}

CandumpSource::CandumpSource(const FrameFileConfig& config, LineReader reader)
    : RecordedFrames{config}, reader_{std::move(reader)} {
  first_line_.reserve(kFirstLine);
}

Result<bool> CandumpSource::do_wait(std::chrono::nanoseconds timeout) noexcept {
  return stopped() || reader_.wait(timeout);
}

CandumpSource::Step CandumpSource::read_one(CanFrame& frame) noexcept {
  std::string_view line;
  switch (reader_.next(line)) {
    case LineReader::Status::kLine:
      return take_line(line, frame);
    case LineReader::Status::kTooLong:
      return line.front() == '(' ? bad_line(line, {"a line of candump's length", line.data()})
                                 : ignore_line(line);
    case LineReader::Status::kTail:
      health_.truncated = true;
      remember_first(line);
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

CandumpSource::Step CandumpSource::take_line(std::string_view line, CanFrame& frame) noexcept {
  if (line.empty() || line.front() != '(') return ignore_line(line);
  CandumpFault fault = parser_.parse(line, frame);
  if (fault.expected != nullptr) return bad_line(line, fault);
  recognised_ = true;
  if (!is_wanted(parser_.interface_name())) {
    ++health_.ignored;
    return Step::kNoFrame;
  }
  const std::optional<std::uint8_t> index = interfaces_.index_of(parser_.interface_name());
  if (!index) return bad_line(line, {"at most 255 interfaces", parser_.interface_name().data()});
  frame.interface_index = *index;
  fault = check_time(line, frame);
  if (fault.expected != nullptr) return bad_line(line, fault);
  return Step::kFrame;
}

// Looking ahead moves the buffer, and `line` with it: a fault must be reported before, or without
// it.
CandumpFault CandumpSource::check_time(std::string_view line, CanFrame& frame) noexcept {
  const std::int64_t step_ns = frame.time_ns - newest_ns_;
  if (any_frame_ && step_ns < 0) {
    if (step_ns <= -hal::kSecondNs)
      return {"a time that does not go back by a second or more", line.data()};
    ++health_.reordered;
    frame.time_ns = newest_ns_;
  }
  if ((!any_frame_ || step_ns > hal::kSecondNs) && next_goes_back(frame.time_ns)) {
    return {"a time that is not a second or more ahead of the next line", nullptr};
  }
  any_frame_ = true;
  newest_ns_ = frame.time_ns;
  return {};
}

// Of the next lines most are a second or more before this one: it and its like are wrong, not they.
bool CandumpSource::next_goes_back(std::int64_t time_ns) noexcept {
  constexpr int kLines = 64;
  std::string_view text = reader_.peek();
  int back = 0;
  int good = 0;
  for (int lines = 0; lines < kLines; ++lines) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) break;
    CanFrame next;
    CandumpLine parser;
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    text.remove_prefix(end + 1);
    if (parser.parse(line, next).expected != nullptr) continue;
    ++good;
    if (next.time_ns <= time_ns - hal::kSecondNs) ++back;
  }
  return 2 * back > good;
}

void CandumpSource::remember_first(std::string_view line) noexcept {
  if (first_line_.empty()) first_line_ = line.substr(0, kFirstLine);
}

CandumpSource::Step CandumpSource::ignore_line(std::string_view line) noexcept {
  ++health_.ignored;
  if (recognised_) return Step::kNoFrame;
  remember_first(line);
  if (health_.ignored < kLinesToJudge) return Step::kNoFrame;
  return stop(Errc::kMalformed, wrong_kind());
}

CandumpSource::Step CandumpSource::bad_line(std::string_view line,
                                            const CandumpFault& fault) noexcept {
  ++health_.malformed;
  if (!recognised_) remember_first(line);
  if (skip_bad_lines_) return Step::kNoFrame;
  const std::string where = fmt::format("{}:{}", reader_.name(), reader_.line_number());
  if (fault.at == nullptr) {
    return stop(Errc::kMalformed, fmt::format("{}: expected {}", where, fault.expected));
  }
  const auto column = static_cast<std::size_t>(fault.at - line.data());
  return stop(Errc::kMalformed,
              fmt::format("{}:{}: found {}, expected {}", where, column + 1,
                          quote(line.substr(std::min(column, line.size()))), fault.expected));
}

CandumpSource::Step CandumpSource::end_of_file() noexcept {
  health_.truncated = health_.truncated || reader_.is_cut_off();
  if (recognised_) return stop(Errc::kEndOfStream, {});
  if (reader_.line_number() == 0) {
    return stop(Errc::kMalformed,
                fmt::format("{}: is empty, expected {}", reader_.name(), kExample));
  }
  return stop(Errc::kMalformed, wrong_kind());
}

std::string CandumpSource::wrong_kind() const {
  const std::string_view first = first_line_;
  const bool binary = first.find('\0') != std::string_view::npos;
  const bool table = !binary && first.find_first_of(",;\t") != std::string_view::npos;
  const auto foreign = foreign_kind(first);
  const std::string_view kind = foreign  ? foreign->name
                                : binary ? "binary data"
                                : table  ? "what looks like a table (CSV)"
                                         : "no frame";
  return fmt::format("{}: found {} beginning {}, expected {}", reader_.name(), kind, quote(first),
                     kExample);
}

}  // namespace dampline::drivers
