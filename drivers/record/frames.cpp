// SPDX-License-Identifier: MIT
#include "drivers/record/frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "drivers/asc/parser.hpp"
#include "drivers/blf/source.hpp"
#include "drivers/candump/screen.hpp"
#include "drivers/candump/source.hpp"
#include "drivers/mdf/source.hpp"
#include "drivers/record/frame_lines.hpp"
#include "drivers/trc/parser.hpp"

namespace dampline::drivers {
namespace {

template <class Source>
Outcome<std::unique_ptr<RecordedFrames>> as_frames(Outcome<std::unique_ptr<Source>> opened) {
  if (!opened) return opened.failure();
  return std::unique_ptr<RecordedFrames>{std::move(opened.value())};
}

}  // namespace

Result<std::size_t> RecordedFrames::do_read(std::span<CanFrame> out) noexcept {
  std::size_t count = 0;
  while (count < out.size() && !stopped_) {
    const Step step = read_one(out[count]);
    if (step == Step::kFrame) ++count;
    if (step == Step::kWait) break;
  }
  health_.frames += count;
  if (count == 0 && stopped_) return reason_;
  return count;
}

RecordedFrames::Step RecordedFrames::stop(Errc reason, std::string text) noexcept {
  stopped_ = true;
  reason_ = reason;
  error_ = std::move(text);
  return Step::kStop;
}

bool RecordedFrames::is_wanted(std::string_view interface) const noexcept {
  return wanted_.empty() || std::find(wanted_.begin(), wanted_.end(), interface) != wanted_.end();
}

Outcome<std::unique_ptr<RecordedFrames>> open_frames(const FrameFileConfig& config) {
  const Outcome<RecordFormat> format = detect_format(config.path);
  if (!format) return format.failure();
  return open_frames(config, format.value());
}

Outcome<std::unique_ptr<RecordedFrames>> open_frames(const FrameFileConfig& config,
                                                     RecordFormat format) {
  if (const std::string_view way_out = way_out_of(format); !way_out.empty())
    return Failure{Errc::kMalformed, fmt::format("{}: is {}, which is not read: {}", config.path,
                                                 name_of(format), way_out)};
  switch (format) {
    case RecordFormat::kCandumpScreen:
      return FrameLines::open(config, std::make_unique<CandumpScreen>(
                                          has_time_differences(config.path), config.untimed));
    case RecordFormat::kAsc:
      return FrameLines::open(config, std::make_unique<AscParser>());
    case RecordFormat::kTrc:
      return FrameLines::open(config, std::make_unique<TrcParser>());
    case RecordFormat::kBlf:
      return BlfSource::open(config);
    case RecordFormat::kMdf4:
      return MdfSource::open(config);
    default:
      return as_frames(CandumpSource::open(config));
  }
}

}  // namespace dampline::drivers
