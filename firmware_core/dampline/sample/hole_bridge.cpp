// SPDX-License-Identifier: MIT
#include "dampline/sample/hole_bridge.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "dampline/numeric/cholesky.hpp"
#include "dampline/numeric/wide.hpp"
#include "dampline/sample/screen.hpp"

namespace dampline {
namespace {

constexpr double kTaperPower = 0.375;  // mean square of Hann's window
constexpr double kRidge = 1e-6;        // of the power: rounding alone must not make a model

/// Weights of the prediction's error; `left`: its power in units of the correlation's.
std::array<double, HoleBridge::kOrder + 1> prediction_error(
    const std::array<double, HoleBridge::kOrder + 1>& correlation, double& left) noexcept {
  constexpr auto kOrder = static_cast<std::size_t>(HoleBridge::kOrder);
  std::array<double, kOrder + 1> a{1.0};
  left = correlation[0] * (1.0 + kRidge);
  for (std::size_t m = 1; m <= kOrder; ++m) {  // Levinson and Durbin
    double sum = 0.0;
    for (std::size_t i = 0; i < m; ++i) sum += a[i] * correlation[m - i];
    const double reflection = -sum / left;
    std::array<double, kOrder + 1> next = a;
    for (std::size_t i = 1; i <= m; ++i) next[i] = a[i] + reflection * a[m - i];
    a = next;
    left *= 1.0 - reflection * reflection;
  }
  return a;
}

double value_of(const Sample& sample, std::size_t lane) noexcept {
  return lane < kChannels ? sample.accel_mps2[lane] : double{sample.extra_mps2[lane - kChannels]};
}

}  // namespace

HoleBridge::HoleBridge() noexcept {
  for (std::size_t i = 0; i < taper_.size(); ++i) {
    const double turn = (static_cast<double>(i) + 0.5) / static_cast<double>(kPast);
    taper_[i] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * turn);
  }
}

void HoleBridge::push(const Sample& sample) noexcept {
  if (count_ > 0) {
    const Sample& last = held(count_ - 1).sample;
    const std::int64_t missing = sample.tick - last.tick - 1;
    const std::int64_t first_ns = last.time_ns;
    Sample between = last;
    between.accel_mps2.fill(std::numeric_limits<double>::quiet_NaN());
    between.saturated = 0;
    between.lost = true;
    for (std::int64_t i = 1; missing <= kMostMissing && i <= missing; ++i) {
      ++between.tick;
      between.time_ns = first_ns + (sample.time_ns - first_ns) * i / (missing + 1);
      take(between);
    }
  }
  take(sample);
}

void HoleBridge::take(const Sample& sample) noexcept {
  const bool goes_on = count_ > 0 && sample.tick == held(count_ - 1).sample.tick + 1;
  const std::int64_t first = goes_on ? held(count_ - 1).first : count_;
  Held& now = held(count_);
  now = {sample, first, 0};
  for (std::size_t l = 0; l < kLanes; ++l) {
    const double value = value_of(sample, l);
    if (!is_number(value)) now.missing |= 1U << l;
    lanes_[l].values[slot_] = lanes_[l].values[slot_ + kKept] = value;
  }
  if (++slot_ == kKept) slot_ = 0;
  ++count_;
}

void HoleBridge::put(Lane& lane, std::int64_t place, double value) noexcept {
  const auto at = static_cast<std::size_t>(place % kKept);
  lane.values[at] = lane.values[at + kKept] = value;
}

bool HoleBridge::pop(Sample& out) noexcept {
  while (count_ - next_ > (finished_ ? 0 : kAhead)) {
    const std::int64_t place = next_++;
    const bool is_complete = complete(place);
    if (!is_complete) intact_ = place + 1;
    out = held(place).sample;
    if (is_complete || !out.lost) return true;
  }
  return false;
}

bool HoleBridge::complete(std::int64_t place) noexcept {
  Held& now = held(place);
  if (now.missing == 0 && intact_ != place) return true;
  bool is_complete = true;
  for (std::size_t l = 0; l < kLanes; ++l) {
    lanes_[l].refused = is_missing(l, place) && !fill(l, place);
    is_complete = is_complete && !lanes_[l].refused;
    // Nobody looks at an extra by itself: the whole sample is none.
    if (lanes_[l].refused && l >= kChannels)
      now.sample.accel_mps2[0] = std::numeric_limits<double>::quiet_NaN();
  }
  if (now.sample.bridged != 0) ++bridged_;
  return is_complete;
}

BridgeFigures HoleBridge::figures() const noexcept {
  BridgeFigures out;
  const auto all = static_cast<double>(std::max<std::int64_t>(next_, 1));
  out.share = static_cast<double>(bridged_) / all;
  for (std::size_t l = 0; l < kLanes; ++l) {
    const Lane& lane = lanes_[l];
    out.values += lane.filled;
    if (l >= kChannels || lane.filled == 0) continue;
    out.error_mps2[l] = std::sqrt(lane.sum_squares / static_cast<double>(lane.filled));
    out.noise_mps2[l] = std::sqrt(lane.sum_squares / all);
  }
  return out;
}

/// The last place up to which ticks go on from this one, among those that are known.
std::int64_t HoleBridge::last_of(std::int64_t place) noexcept {
  std::int64_t last = place;
  const std::int64_t most = std::min(count_ - 1, place + kAhead);
  while (last < most && held(last + 1).first <= place) ++last;
  return last;
}

bool HoleBridge::is_short(std::size_t lane, std::int64_t place, std::int64_t last) noexcept {
  std::int64_t end = place;
  while (end <= last && is_missing(lane, end)) ++end;
  return end - place <= kMostMissing && last - end + 1 >= kLeastAhead;
}

HoleBridge::Unknown HoleBridge::unknown_of(std::size_t lane, std::int64_t place,
                                           std::int64_t last) noexcept {
  Unknown out{.last = last};
  for (std::int64_t i = place; i <= last; ++i) {
    if (!is_missing(lane, i)) continue;
    if (out.size == kMostUnknown) {
      out.last = i - 1;
      return out;
    }
    out.place[static_cast<std::size_t>(out.size++)] = i;
  }
  return out;
}

// The prediction's errors from here on are linear in the unknown values, the first of which is
// wanted: least squares.
bool HoleBridge::solve(const Lane& lane, std::int64_t first, const Unknown& unknown,
                       Estimate& out) noexcept {
  using Solver = Cholesky<kMostUnknown>;
  Solver::Matrix normal = Solver::Matrix::Zero();
  Solver::Vector right = Solver::Vector::Zero();
  for (std::int64_t t = std::max(unknown.place[0], first + kOrder); t <= unknown.last; ++t) {
    const double* const newest = up_to(lane, t);
    double known = 0.0;
    for (std::int64_t k = 0; k <= kOrder; ++k)
      if (is_number(newest[-k]))
        known += lane.model[static_cast<std::size_t>(k)] * (newest[-k] - lane.mean);
    const auto weight = [&](int i) {
      const std::int64_t lag = t - unknown.place[static_cast<std::size_t>(i)];
      return lag < 0 || lag > kOrder ? 0.0 : lane.model[static_cast<std::size_t>(lag)];
    };
    for (int i = 0; i < unknown.size; ++i) {
      right[i] -= weight(i) * known;
      for (int j = 0; j <= i; ++j) normal(i, j) += weight(i) * weight(j);
    }
  }
  Solver solver;
  if (!solver.factor(normal, unknown.size)) return false;
  solver.solve(right);
  Solver::Vector column = Solver::Vector::Unit(0);  // becomes the first of the inverse
  solver.solve(column);
  out = {lane.mean + right[0], std::sqrt(lane.unforeseen * column[0])};
  return true;
}

bool HoleBridge::fill(std::size_t index, std::int64_t place) noexcept {
  Lane& lane = lanes_[index];
  const std::int64_t first = std::max(held(place).first, intact_);
  const std::int64_t last = last_of(place);
  if (lane.refused || place - first < kLeastBefore || !is_short(index, place, last)) return false;
  if (lane.learned < 0 || place - lane.learned >= kLearnAgain) learn(lane, place, first);
  Estimate found;
  if (!solve(lane, first, unknown_of(index, place, last), found)) return false;
  put(lane, place, found.value);
  Sample& sample = held(place).sample;
  if (index < kChannels) {
    sample.accel_mps2[index] = found.value;
  } else {
    sample.extra_mps2[index - kChannels] = static_cast<float>(found.value);
  }
  sample.bridged = static_cast<std::uint8_t>(sample.bridged | 1U << index);
  ++lane.filled;
  lane.sum_squares += found.std * found.std;
  return true;
}

void HoleBridge::learn(Lane& lane, std::int64_t place, std::int64_t first) noexcept {
  const std::int64_t size = std::min(place - first, kPast);
  if (size < kPast / 2) return;
  const double* const values = up_to(lane, place - 1) - (size - 1);
  double sum = 0.0;
  for (std::int64_t i = 0; i < size; ++i) sum += values[i];
  const double mean = sum / static_cast<double>(size);
  std::array<double, kPast> x{};
  const auto n = static_cast<std::size_t>(size);
  for (std::size_t i = 0; i < n; ++i) x[i] = taper_[i * kPast / n] * (values[i] - mean);
  std::array<double, kOrder + 1> correlation{};
  for (std::size_t k = 0; k < correlation.size(); ++k)
    correlation[k] = wide_dot(x.data(), x.data() + k, n - k);
  if (!(correlation[0] > 0.0)) return;
  lane.model = prediction_error(correlation, lane.unforeseen);
  lane.unforeseen /= kTaperPower * static_cast<double>(size);
  lane.mean = mean;
  lane.learned = place;
}

}  // namespace dampline
