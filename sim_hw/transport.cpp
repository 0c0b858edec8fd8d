// SPDX-License-Identifier: MIT
#include "sim_hw/transport.hpp"

#include <algorithm>

namespace dampline::sim {
namespace {
constexpr std::int64_t kSwapDelayNs = 30'000;  // below the distance of the nodes' frames
}

Transport::Transport(const TransportConfig& config, std::uint64_t seed)
    : config_(config),
      random_(seed, Stream::kTransport),
      swap_done_(config.swap_time_s < 0.0),
      active_(config.loss_fraction > 0.0 || config.swap_fraction > 0.0 || !swap_done_) {}

Transport::Held* Transport::held_for(std::uint32_t id) noexcept {
  const auto found = std::ranges::find_if(
      held_, [&](const Held& held) { return held.full && held.frame.id == id; });
  return found == held_.end() ? nullptr : &*found;
}

bool Transport::swaps(std::size_t position, double time_s) noexcept {
  if (!swap_done_ && position == 0 && time_s >= config_.swap_time_s) {
    swap_done_ = true;
    return true;
  }
  return config_.swap_fraction > 0.0 && random_.uniform() < config_.swap_fraction;
}

std::span<const CanFrame> Transport::pass(const std::array<CanFrame, kChannels>& frames,
                                          double time_s) noexcept {
  count_ = 0;
  for (std::size_t i = 0; i < kChannels; ++i) {
    const CanFrame& frame = frames[i];
    if (!active_) {
      emit(frame);
      continue;
    }
    if (config_.loss_fraction > 0.0 && random_.uniform() < config_.loss_fraction) continue;
    if (Held* held = held_for(frame.id)) {
      emit(frame);
      CanFrame late = held->frame;
      late.time_ns = frame.time_ns + kSwapDelayNs;
      emit(late);
      held->full = false;
    } else if (swaps(i, time_s)) {
      *std::ranges::find(held_, false, &Held::full) = {true, frame};
    } else {
      emit(frame);
    }
  }
  std::stable_sort(out_.begin(), out_.begin() + static_cast<std::ptrdiff_t>(count_),
                   [](const CanFrame& a, const CanFrame& b) { return a.time_ns < b.time_ns; });
  return {out_.data(), count_};
}

}  // namespace dampline::sim
