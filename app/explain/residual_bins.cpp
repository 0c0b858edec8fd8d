// SPDX-License-Identifier: MIT
#include "app/explain/residual_bins.hpp"

#include <cmath>
#include <utility>

namespace dampline::app {
namespace {

constexpr std::uint64_t kFewestSamples = 20;

}  // namespace

ResidualBins::ResidualBins(std::string over, double low, double high, std::size_t bins)
    : over_{std::move(over)},
      low_{low},
      width_{(high - low) / static_cast<double>(bins)},
      sums_(bins) {}

void ResidualBins::add(double place, const EvidencePoint& point) {
  const double at = std::floor((place - low_) / width_);
  if (!(at >= 0.0 && at < static_cast<double>(sums_.size()))) return;
  Sums& s = sums_[static_cast<std::size_t>(at)];
  const double before = point.before_n();
  const double after = point.after_n();
  ++s.samples;
  s.before += before;
  s.before_squares += before * before;
  s.after += after;
  s.after_squares += after * after;
}

std::vector<ResidualRow> ResidualBins::rows() const {
  std::vector<ResidualRow> out;
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const Sums& s = sums_[i];
    if (s.samples < kFewestSamples) continue;
    const auto n = static_cast<double>(s.samples);
    out.push_back({over_, low_ + (static_cast<double>(i) + 0.5) * width_, s.samples, s.before / n,
                   std::sqrt(s.before_squares / n), s.after / n, std::sqrt(s.after_squares / n)});
  }
  return out;
}

}  // namespace dampline::app
