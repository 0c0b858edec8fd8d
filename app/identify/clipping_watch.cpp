// SPDX-License-Identifier: MIT
#include "app/identify/clipping_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "app/text/format.hpp"

namespace dampline::app {
namespace {

constexpr std::array<std::string_view, kChannels> kChannelNames{"frame", "wheelset1", "wheelset2"};
constexpr std::uint64_t kFewHits = 20;
constexpr double kShare = 2e-4;  // coarse codes repeat their largest value now and then

}  // namespace

std::vector<std::string> ClippingWatch::warnings() const {
  std::vector<std::string> out;
  const auto limit =
      std::max(kFewHits, static_cast<std::uint64_t>(kShare * static_cast<double>(samples_)));
  for (std::size_t c = 0; c < kChannels; ++c) {
    const Extreme& worst = high_[c].hits >= low_[c].hits ? high_[c] : low_[c];
    if (worst.hits < limit || worst.value == -(&worst == &high_[c] ? low_[c] : high_[c]).value)
      continue;
    out.push_back(
        fmt::format("Channel {0} seems to clip: {1} samples stand at its extreme, {2:.4g} "
                    "m/s^2 in size, and the result is not to be trusted. [input.range_mps2] "
                    "{0} = {3:.4g} leaves such stretches out.",
                    kChannelNames[c], format_count(worst.hits), worst.value, 0.999 * worst.value));
  }
  return out;
}

}  // namespace dampline::app
