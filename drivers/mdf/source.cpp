// SPDX-License-Identifier: MIT
#include "drivers/mdf/source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "drivers/record/identifier.hpp"

namespace dampline::drivers {

Outcome<std::unique_ptr<RecordedFrames>> MdfSource::open(const FrameFileConfig& config) {
  auto layout = read_mdf_layout(config.path);
  if (!layout) return layout.failure();
  std::unique_ptr<MdfSource> out{new MdfSource{config, std::move(layout.value())}};
  if (const auto ready = out->prepare(); !ready) return ready.failure();
  return std::unique_ptr<RecordedFrames>{std::move(out)};
}

MdfSource::MdfSource(const FrameFileConfig& config, MdfLayout layout)
    : RecordedFrames{config}, layout_{std::move(layout)} {}

Outcome<bool> MdfSource::prepare() {
  for (const MdfDataGroup& data_group : layout_.data_groups) {
    std::vector<bool> wanted;
    wanted.reserve(data_group.groups.size());
    for (const MdfGroup& group : data_group.groups) wanted.push_back(MdfFrameGroup::is_one(group));
    if (std::find(wanted.begin(), wanted.end(), true) == wanted.end()) continue;
    Strand strand{MdfRecords{layout_, data_group, wanted}};
    strand.groups.resize(wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      if (!wanted[i]) continue;
      auto group = MdfFrameGroup::make(layout_, data_group, i);
      if (!group) return group.failure();
      strand.groups[i].emplace(std::move(group.value()));
    }
    strands_.push_back(std::move(strand));
  }
  if (strands_.empty())
    return Failure{Errc::kMalformed,
                   fmt::format("{}: holds no frames of a CAN bus (CAN_DataFrame)", layout_.name)};
  return true;
}

std::optional<double> MdfSource::share_read() const noexcept {
  std::uint64_t bytes = 0;
  for (const Strand& strand : strands_) bytes += strand.records.stored_bytes();
  return std::min(1.0, static_cast<double>(bytes) / static_cast<double>(layout_.file->size()));
}

RecordClock MdfSource::clock() const noexcept {
  if (layout_.start_ns == 0) return RecordClock::kRelative;
  return layout_.local_time ? RecordClock::kLocal : RecordClock::kUtc;
}

MdfSource::Step MdfSource::read_one(CanFrame& frame) noexcept {
  Strand* const next = earliest();
  return next != nullptr && deliver(*next, frame) ? Step::kFrame : Step::kNoFrame;
}

/// The strand whose frame is next; null: there is none, or reading stopped.
MdfSource::Strand* MdfSource::earliest() noexcept {
  Strand* out = nullptr;
  for (Strand& strand : strands_) {
    if (!fill(strand)) return nullptr;
    if (strand.ready && (out == nullptr || strand.frame.time_ns < out->frame.time_ns))
      out = &strand;
  }
  if (out != nullptr) return out;
  if (health_.frames == 0 && records_ == 0 && !health_.truncated) {
    stop_at("holds no frame");
  } else {
    stop(Errc::kEndOfStream, {});
  }
  return nullptr;
}

/// False: reading stopped.
bool MdfSource::fill(Strand& strand) noexcept {
  while (!strand.ready && !strand.ended) {
    switch (strand.records.next()) {
      case MdfRecords::Step::kRecord:
        if (!take_record(strand)) return false;
        break;
      case MdfRecords::Step::kCut:
        health_.truncated = true;
        strand.ended = true;
        break;
      case MdfRecords::Step::kEnd:
        health_.truncated = health_.truncated || strand.records.is_short();
        strand.ended = true;
        break;
      case MdfRecords::Step::kFault:
        stop_at(strand.records.fault());
        return false;
    }
  }
  return true;
}

bool MdfSource::take_record(Strand& strand) noexcept {
  MdfFrameGroup& group = *strand.groups[strand.records.group()];
  ++records_;
  const char* wrong = group.read(strand.records.record(), strand.frame, strand.channel);
  if (wrong == nullptr) {
    strand.frame.time_ns += layout_.start_ns;
    strand.ready = true;
    return true;
  }
  if (const std::string fault = group.fault(); !fault.empty()) {
    stop_at(fault);
    return false;
  }
  return bad_frame(wrong);
}

/// False: it is not wanted, or wrong.
bool MdfSource::deliver(Strand& strand, CanFrame& frame) noexcept {
  strand.ready = false;
  frame = strand.frame;
  ChannelName name;
  const std::string_view interface = name.set(strand.channel);
  const auto index = is_wanted(interface) ? interfaces_.index_of(interface) : std::nullopt;
  if (!index) {
    ++health_.ignored;
    return false;
  }
  frame.interface_index = *index;
  if (gate_.pass(frame.time_ns, health_)) return true;
  bad_frame("a time that goes back by a second or more");
  return false;
}

bool MdfSource::bad_frame(const char* what) noexcept {
  ++health_.malformed;
  if (skip_bad_lines_) return true;
  stop_at(fmt::format("record {}: found {}", records_, what));
  return false;
}

void MdfSource::stop_at(const std::string& fault) noexcept {
  stop(Errc::kMalformed, fmt::format("{}: {}", layout_.name, fault));
}

}  // namespace dampline::drivers
