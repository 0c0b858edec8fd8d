// SPDX-License-Identifier: MIT
#include "dampline/guard/fault_log.hpp"

#include <algorithm>
#include <cmath>

namespace dampline {

const Fault* FaultLog::find(FaultKind kind, FaultChannel channel) const noexcept {
  for (std::size_t i = 0; i < size_; ++i) {
    if (faults_[i].kind == kind && faults_[i].channel == channel) return &faults_[i];
  }
  return nullptr;
}

bool FaultLog::has(FaultKind kind) const noexcept {
  return std::any_of(faults_.begin(), faults_.begin() + static_cast<std::ptrdiff_t>(size_),
                     [kind](const Fault& fault) { return fault.kind == kind; });
}

void FaultLog::report(FaultKind kind, FaultChannel channel, double time_s, double size,
                      std::uint64_t events) noexcept {
  const Fault* const known = find(kind, channel);
  if (known == nullptr) {
    if (size_ == faults_.size()) return;
    faults_[size_++] = {.kind = kind,
                        .channel = channel,
                        .time_s = time_s,
                        .size = size,
                        .unit = unit_of(kind),
                        .count = events,
                        .last_s = time_s};
    return;
  }
  Fault& fault = faults_[static_cast<std::size_t>(known - faults_.data())];
  fault.count += events;
  fault.last_s = std::max(fault.last_s, time_s);
  if (kind == FaultKind::kLostSamples || kind == FaultKind::kRepeatedSamples) {
    fault.size += size;
  } else if (std::abs(size) > std::abs(fault.size)) {
    fault.size = size;
  }
}

template <typename Change>
void FaultLog::change(std::int64_t first_tick, std::int64_t last_tick, Change what) noexcept {
  const std::int64_t last = second_of(last_tick);
  const std::int64_t first =
      std::max(second_of(std::max<std::int64_t>(first_tick, 0)), last - kSeconds + 1);
  for (std::int64_t second = first; second <= last; ++second) {
    Second& entry = spoilt_[slot(second)];
    if (entry.number != second) entry = {.number = second};
    what(entry);
  }
}

void FaultLog::spoil(FaultKind kind, FaultChannel channel, std::int64_t first_tick,
                     std::int64_t last_tick) noexcept {
  change(first_tick, last_tick, [=](Second& entry) {
    std::uint16_t& kinds = entry.kinds[static_cast<std::size_t>(channel)];
    kinds = static_cast<std::uint16_t>(kinds | 1U << static_cast<unsigned>(kind));
  });
}

void FaultLog::spoil_by_gap(std::int64_t first_tick, std::int64_t last_tick) noexcept {
  spoil(FaultKind::kLostSamples, FaultChannel::kAll, first_tick, last_tick);
  change(first_tick, last_tick, [](Second& entry) { entry.gap = true; });
}

std::uint32_t FaultLog::spoilt(std::int64_t first_tick, std::int64_t last_tick) const noexcept {
  std::uint32_t kinds = 0;
  const std::int64_t last = second_of(last_tick);
  for (std::int64_t second = std::max(second_of(first_tick), last - kSeconds + 1); second <= last;
       ++second) {
    const Second& entry = spoilt_[slot(std::max<std::int64_t>(second, 0))];
    if (entry.number != second) continue;
    for (const std::uint16_t some : entry.kinds) kinds |= some;
    if (entry.gap) kinds |= kGapBit;
  }
  return kinds;
}

bool FaultLog::spoilt(FaultKind kind, FaultChannel channel, std::int64_t tick) const noexcept {
  const std::int64_t second = second_of(tick);
  const Second& entry = spoilt_[slot(std::max<std::int64_t>(second, 0))];
  const unsigned kinds = entry.kinds[static_cast<std::size_t>(channel)];
  return entry.number == second && (kinds >> static_cast<unsigned>(kind) & 1U) != 0;
}

}  // namespace dampline
