// SPDX-License-Identifier: MIT
#include "dampline/guard/change_alarm.hpp"

#include <algorithm>
#include <cmath>

namespace dampline {
namespace {

constexpr double kMostOfThreshold = 1.0 / 3.0;  // that one group adds: no alarm from one or two
constexpr double kLeastShare = 0.5;             // of the other's change: both are the mass

}  // namespace

double ChangeWatch::deviation(std::size_t which) const noexcept {
  if (learnt_ < 2) return 0.0;
  return std::sqrt(tracks_[which].squares / static_cast<double>(learnt_ - 1));
}

void ChangeWatch::learn(const Pair& value) noexcept {
  ++learnt_;
  for (std::size_t i = 0; i < value.size(); ++i) {
    Track& track = tracks_[i];
    const double off = value[i] - track.mean;
    track.mean += off / static_cast<double>(learnt_);
    track.squares += off * (value[i] - track.mean);
  }
}

bool ChangeWatch::judge(std::size_t which, double off, std::int64_t& first) noexcept {
  Track& track = tracks_[which];
  const double allowed = std::max(config_.allowance, config_.sigmas * deviation(which));
  const double most = kMostOfThreshold * config_.threshold;
  const auto add = [&](double& sum, double beyond, std::int64_t& began) {
    if (sum <= 0.0) began = groups_;
    sum = std::max(sum + std::min(beyond, most), 0.0);
  };
  add(track.up, off - allowed, track.up_first);
  add(track.down, -off - allowed, track.down_first);
  first = track.up > 0.0 ? track.up_first : track.down_first;
  // Rounding of three parts must not make a fourth.
  return std::max(track.up, track.down) > (1.0 - 1e-9) * config_.threshold;
}

double ChangeWatch::mean_since(std::size_t which, std::int64_t first) const noexcept {
  const std::int64_t from = std::max(first, groups_ - static_cast<std::int64_t>(kKept) + 1);
  double sum = 0.0;
  for (std::int64_t group = from; group <= groups_; ++group)
    sum += newest_[static_cast<std::size_t>(group) % kKept][which];
  return sum / static_cast<double>(groups_ - from + 1);
}

ChangeAlarm ChangeWatch::alarm(std::size_t which, std::int64_t first) const noexcept {
  const double own = mean_since(which, first);
  const double other = mean_since(1 - which, first);
  const bool both = own * other > 0.0 && std::abs(other) > kLeastShare * std::abs(own) &&
                    std::abs(own) > kLeastShare * std::abs(other);
  if (both) return {DriftingParameter::kMass, first, groups_, std::expm1(-0.5 * (own + other))};
  return {which == 0 ? DriftingParameter::kFriction : DriftingParameter::kStiffness, first, groups_,
          std::expm1(own)};
}

bool ChangeWatch::update(double friction, double stiffness, ChangeAlarm& out) noexcept {
  if (!(friction > 0.0 && stiffness > 0.0)) return false;
  const Pair value{std::log(friction), std::log(stiffness)};
  ++groups_;
  if (learnt_ < config_.least) {
    learn(value);
    return false;
  }
  for (std::size_t i = 0; i < value.size(); ++i)
    newest_[static_cast<std::size_t>(groups_) % kKept][i] = value[i] - tracks_[i].mean;
  bool quiet = true;
  for (std::size_t i = 0; i < value.size(); ++i) {
    std::int64_t first = 0;
    if (judge(i, value[i] - tracks_[i].mean, first)) {
      out = alarm(i, first);
      tracks_ = {};
      learnt_ = 0;
      return true;
    }
    quiet = quiet && tracks_[i].up <= 0.0 && tracks_[i].down <= 0.0;
  }
  if (quiet && learnt_ < config_.learn) learn(value);
  return false;
}

}  // namespace dampline
