// SPDX-License-Identifier: MIT
#include "dampline/guard/wheelset_watch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dampline {
namespace {

// In simulated cars whose wheelsets differ by a tenth of their power, slips reach 5 deviations and
// more, with fits of 0.59 to 1.07 and below -0.49 on either side; what is left is up to 3.3 times
// what it usually is. More than that is left in 0.3 % of the windows at most; with wheel flats, in
// some 10 to 50 %.
constexpr double kDeviations = 4.3;
constexpr double kFits = 0.55;
constexpr double kFitsNot = -0.45;
constexpr double kMostLeft = 4.5;
constexpr double kMostShare =
    0.05;  // or of what is left without the shift: the ends of a slip ring
constexpr double kMostRough = 0.01;     // share of windows with more left than that
constexpr double kRoughWindows = 4500;  // that it is smoothed over; a minute

constexpr std::int64_t kBehind = 128;     // samples: the delay may have either sign
constexpr double kSmoothingS = 10.0;      // of mean and power
constexpr double kSlipRise = 25.0;        // of the squared difference over its median
constexpr double kSlipMatch = 0.15;       // what is left of it one sample off
constexpr double kWholeSlip = 0.03;       // where it is by whole samples exactly
constexpr double kAlike = 0.01;           // of the power: beyond it slips are found otherwise
constexpr double kMoved = 0.2;            // samples: the delay is another
constexpr double kDoubt = 0.08;           // samples; a slip moves the delay of its block by 0.03
constexpr std::int64_t kLeapChunks = 6;   // chunks within which a jump is complete
constexpr std::size_t kNewest = 8;        // blocks
constexpr std::int64_t kQuietTicks = 40;  // on either side of an impact
constexpr double kTogether = 6.0;         // of the squared difference over its median
constexpr double kSettledS = 11.7;        // by then impacts and delay of that time are known
constexpr std::size_t kTooMany = 5;       // slips within kSettledS: rather wheel flats
constexpr double kOutlierShare = 0.02;
constexpr std::uint32_t kEnoughChunks = 300;
constexpr double kSquareUnitMps2 = 1e-3;
constexpr std::int64_t kJitterEvery = 3;  // samples
constexpr double kOutlier = 12.0;         // of the squared difference: not for the regression
constexpr std::size_t kNone = ShiftSums::kNone;
constexpr std::size_t kCubicBlocks = 6;
constexpr double kLeastCubic = 2e-3;  // clean records reach 1e-4
constexpr double kCubicSignificant = 5.0;
constexpr double kBothWays = 0.25;  // the smaller of the two directions over the larger

}  // namespace

SlipFinder::Window SlipFinder::window(std::int64_t tick, std::size_t length,
                                      double sigma) const noexcept {
  ShiftSums sums;
  for (std::size_t i = 0; i < length; ++i) {
    const ShiftSums& chunk = chunks_[(count_ - i) % kMost];
    for (std::size_t s = 0; s < ShiftSums::kShifts; ++s) {
      sums.error[s] += chunk.error[s];
      sums.change[s] += chunk.change[s];
    }
  }
  const auto samples = static_cast<double>(length * std::size_t{ShiftSums::kSamples});
  const auto best = static_cast<std::size_t>(
      std::min_element(sums.error.begin(), sums.error.end()) - sums.error.begin());
  Window out{.tick = tick,
             .shift = best,
             .left = sums.error[best] / (samples * sigma * sigma),
             .share = sums.error[best] / sums.error[ShiftSums::kNone]};
  for (std::size_t s = 0; s < ShiftSums::kShifts; ++s) {
    if (s == ShiftSums::kNone || !(sums.change[s] > 0.0)) continue;
    const double gain = sums.error[ShiftSums::kNone] - sums.error[s];
    out.fit[s] = gain / sums.change[s];
    if (s == best) out.deviations = gain / (2.0 * sigma * std::sqrt(sums.change[s]));
  }
  return out;
}

bool SlipFinder::is_slip(const Window& found, const Window& before, const Window& after) noexcept {
  const std::size_t s = found.shift;
  const int samples = static_cast<int>(s) - ShiftSums::kReach;
  return std::abs(samples) <= kMostShift && found.deviations >= kDeviations &&
         (found.left <= kMostLeft || found.share <= kMostShare) && found.fit[s] >= kFits &&
         before.fit[s] <= kFitsNot && after.fit[s] <= kFitsNot;
}

bool SlipFinder::update(std::int64_t tick, const ShiftSums& chunk, std::int64_t delay_samples,
                        double sigma, Slip& out) noexcept {
  const std::int64_t whole = delay_samples / ShiftSums::kSamples - 1;
  if (whole < 1 || whole > static_cast<std::int64_t>(kMost) || !(sigma > 0.0)) {
    restart();
    return false;
  }
  const auto length = static_cast<std::size_t>(whole);
  chunks_[count_ % kMost] = chunk;
  const Window newest = window(tick, length, sigma);
  windows_[count_++ % kRing] = newest;
  rough_ += ((newest.left > kMostLeft ? 1.0 : 0.0) - rough_) / kRoughWindows;
  const std::size_t apart = length + 2;
  if (count_ < 3 * apart || tick < quiet_until_ || rough_ > kMostRough) return false;
  const Window& found = back(apart);
  if (!is_slip(found, back(2 * apart), newest)) return false;
  quiet_until_ = tick + 2 * delay_samples;
  out = {.tick = found.tick - (whole - 1) * ShiftSums::kSamples,
         .samples = static_cast<int>(found.shift) - ShiftSums::kReach};
  return true;
}

WheelsetWatch::WheelsetWatch(double sample_rate_hz) noexcept
    : rate_hz_{sample_rate_hz}, jitter_{sample_rate_hz} {}

void WheelsetWatch::restart() noexcept {
  count_ = 0;
  has_delay_ = false;
  chunk_samples_ = 0;
  last_error_ = {};
  finder_.restart();
  apart_ = too_long_ = false;
  for (BlockSeries& series : cubic_) series.clear();
  jitter_.restart();
}

// The fraction by a sinc of 24 taps under a Hann window.
void WheelsetWatch::set_delay(double delay_s) noexcept {
  const double samples = delay_s * rate_hz_;
  if (std::abs(samples - delay_samples_) > kMoved) {
    apart_ = too_long_ = false;
    together_tick_ = -1;
  }
  delay_samples_ = samples;
  const double below = std::floor(samples);
  whole_ = static_cast<std::int64_t>(below);
  const double fraction = samples - below;
  double sum = 0.0;
  for (int i = 0; i < 2 * kHalf; ++i) {
    const double x = static_cast<double>(i - kHalf + 1) - fraction;
    const double sinc =
        std::abs(x) < 1e-12 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x);
    const double window = 0.5 + 0.5 * std::cos(std::numbers::pi * x / (kHalf + 0.5));
    taps_[static_cast<std::size_t>(i)] = sinc * window;
    sum += taps_[static_cast<std::size_t>(i)];
  }
  for (double& tap : taps_) tap /= sum;
  has_delay_ = true;
}

bool WheelsetWatch::differs_from(double delay_s) const noexcept {
  return std::abs(delay_s * rate_hz_ - delay_samples_) > kDoubt;
}

void WheelsetWatch::update(std::int64_t tick, double wheelset1_mps2, double wheelset2_mps2,
                           FaultLog& log) noexcept {
  const double share = 1.0 / (kSmoothingS * rate_hz_);
  const std::array<double, 2> value{wheelset1_mps2, wheelset2_mps2};
  if (count_ == 0) mean_ = value;
  for (std::size_t i = 0; i < 2; ++i) {
    mean_[i] += share * (value[i] - mean_[i]);
    const double x = value[i] - mean_[i];
    square_[i] += share * (x * x - square_[i]);
    ring(i == 0 ? one_ : two_, count_) = x;
  }
  ++count_;
  if (!has_delay_ || count_ < 2 * kBehind) return;
  compare(tick - kBehind);
  if (++chunk_samples_ % ShiftSums::kSamples == 0) find_slip();
  if (chunk_samples_ != kChunk) return;
  end_chunk();
  report_slips(tick, log);
}

void WheelsetWatch::Direction::add(double x, double c, double y) noexcept {
  xx += x * x;
  xc += x * c;
  cc += c * c;
  xy += x * y;
  cy += c * y;
}

void WheelsetWatch::Direction::add(const Direction& other) noexcept {
  xx += other.xx;
  xc += other.xc;
  cc += other.cc;
  xy += other.xy;
  cy += other.cy;
}

double WheelsetWatch::Direction::cubic() const noexcept {
  const double linear = cc * xy - xc * cy;
  return linear == 0.0 ? 0.0 : (xx * cy - xc * xy) / linear;
}

void WheelsetWatch::compare(std::int64_t tick) noexcept {
  const std::int64_t n = count_ - 1 - kBehind;
  double delayed = 0.0;
  for (int i = 0; i < 2 * kHalf; ++i) {
    delayed += taps_[static_cast<std::size_t>(i)] * ring(one_, n - whole_ - (i - kHalf + 1));
  }
  ring(delayed_, n) = delayed;
  const std::int64_t m = n - kReach;
  const double two = ring(two_, m);
  const double one = ring(delayed_, m);
  for (std::size_t s = 0; s < kShifts; ++s) {
    const double shifted = ring(delayed_, m - kReach + static_cast<std::int64_t>(s));
    sums_.error[s] += (two - shifted) * (two - shifted);
    sums_.change[s] += (one - shifted) * (one - shifted);
  }
  if (m % kJitterEvery == 0) watch_jitter(m);
  chunk_tick_ = tick - kReach;
  const auto cubic = [](double x, double power) { return x * x * x / power - 3.0 * x; };
  chunk_[0].add(one, cubic(one, square_[0] + 1e-12), two);
  chunk_[1].add(two, cubic(two, square_[1] + 1e-12), one);
}

// The slope by central differences of sixth order: 2 % of it is missing at a fifth of the rate.
void WheelsetWatch::watch_jitter(std::int64_t n) noexcept {
  const auto across = [&](std::int64_t k) { return ring(two_, n + k) - ring(two_, n - k); };
  const double slope = 0.75 * across(1) - 0.15 * across(2) + across(3) / 60.0;
  jitter_.update(ring(two_, n), slope, ring(two_, n) - ring(delayed_, n));
}

void WheelsetWatch::end_chunk() noexcept {
  const double mean_square = error_[kNone] / static_cast<double>(kChunk);
  const double usual = usual_.median() * kSquareUnitMps2 * kSquareUnitMps2;
  usual_square_ = usual_.count() > kEnoughChunks ? usual : 0.0;
  const auto size =
      static_cast<std::uint64_t>(std::min(mean_square, 1e6) / (kSquareUnitMps2 * kSquareUnitMps2));
  usual_.add(size);
  block_usual_.add(size);
  if (usual_.count() > kEnoughChunks) {
    if (usual < kAlike * square_[1]) follow_slip();
    const bool ordinary = mean_square < kOutlier * usual + kOutlierShare * square_[1];
    for (std::size_t i = 0; ordinary && i < 2; ++i) block_[i].add(chunk_[i]);
    jitter_.end_chunk(ordinary);
  }
  last_error_ = error_;
  error_ = {};
  chunk_ = {};
  chunk_samples_ = 0;
}

// A slip begins with the wheelsets whole samples apart and ends, the delay later, with them
// together. What stays apart is a change of the delay.
void WheelsetWatch::follow_slip() noexcept {
  const double usual = usual_.median() * kSquareUnitMps2 * kSquareUnitMps2;
  std::size_t best = 0;
  for (std::size_t s = 1; s < kShifts; ++s) {
    if (error_[s] + last_error_[s] < error_[best] + last_error_[best]) best = s;
  }
  const double apart = (error_[kNone] + last_error_[kNone]) / (2.0 * kChunk);
  const double matched = (error_[best] + last_error_[best]) / (2.0 * kChunk);
  const std::int64_t length = chunk_tick_ - now_.tick;
  if (apart < kTogether * usual) together_tick_ = chunk_tick_;
  const int shift = static_cast<int>(best) - kReach;
  const bool is_match = matched < kSlipMatch * apart && std::abs(shift) < kReach;
  if (apart > kSlipRise * usual && is_match) {
    if (!apart_ || shift != now_.samples) {
      now_ = {chunk_tick_, shift};
      whole_slip_ = false;
    }
    whole_slip_ = whole_slip_ || matched < std::max(kTogether * usual, kWholeSlip * apart);
    apart_ = true;
    const bool at_once = together_tick_ >= 0 && chunk_tick_ - together_tick_ < kLeapChunks * kChunk;
    if (at_once && std::abs(shift) >= 2) leap_tick_ = chunk_tick_;
    too_long_ = chunk_tick_ - now_.tick > std::abs(whole_) + 4 * kChunk;
    const bool since_leap = leap_tick_ >= 0 && chunk_tick_ - leap_tick_ < kQuietTicks + 2 * kBehind;
    if (too_long_ && since_leap) jump_tick_ = leap_tick_;
  } else if (apart_ && apart < kTogether * usual) {
    const bool full_length = length + kChunk >= std::abs(whole_);
    if (whole_slip_ && !too_long_ && full_length) hold(now_);
    apart_ = too_long_ = false;
  }
}

void WheelsetWatch::hold(const Slip& slip) noexcept {
  const auto is_same = [&](const Slip& held) {
    return std::abs(held.tick - slip.tick) < std::abs(whole_);
  };
  const auto* const end = slips_.begin() + static_cast<std::ptrdiff_t>(slip_count_);
  if (slip_count_ == slips_.size() || std::any_of(slips_.cbegin(), end, is_same)) return;
  slips_[slip_count_++] = slip;
}

// Where the wheelsets differ too much for follow_slip(), and where a slip is too short for it.
void WheelsetWatch::find_slip() noexcept {
  for (std::size_t s = 0; s < kShifts; ++s) error_[s] += sums_.error[s];
  Slip slip;
  const bool found =
      finder_.update(chunk_tick_, sums_, std::abs(whole_), std::sqrt(usual_square_), slip);
  sums_ = {};
  if (found) hold(slip);
}

bool WheelsetWatch::struck(const Slip& slip, std::int64_t tick) const noexcept {
  return std::abs(slip.tick - tick) < kQuietTicks + std::abs(whole_);
}

void WheelsetWatch::strike(std::int64_t tick) noexcept {
  strikes_[strike_count_++ % strikes_.size()] = tick;
  const auto near = [&](const Slip& slip) { return struck(slip, tick); };
  auto* const end = slips_.begin() + static_cast<std::ptrdiff_t>(slip_count_);
  slip_count_ =
      static_cast<std::size_t>(std::remove_if(slips_.begin(), end, near) - slips_.begin());
}

void WheelsetWatch::report_slips(std::int64_t tick, FaultLog& log) noexcept {
  if (slip_count_ >= kTooMany) slip_count_ = 0;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < slip_count_; ++i) {
    const Slip slip = slips_[i];
    if (static_cast<double>(tick - slip.tick) < kSettledS * rate_hz_) {
      slips_[kept++] = slip;
      continue;
    }
    const std::size_t known = std::min(strike_count_, strikes_.size());
    if (std::any_of(strikes_.begin(), strikes_.begin() + static_cast<std::ptrdiff_t>(known),
                    [&](std::int64_t strike) { return struck(slip, strike); })) {
      continue;
    }
    const FaultKind kind = slip.samples > 0 ? FaultKind::kLostSamples : FaultKind::kRepeatedSamples;
    log.report(kind, FaultChannel::kAll, log.seconds(slip.tick), std::abs(slip.samples));
    log.spoil(kind, FaultChannel::kAll, slip.tick - 2 * kChunk, slip.tick + std::abs(whole_));
  }
  slip_count_ = kept;
}

void WheelsetWatch::close_block(bool sound, std::int64_t tick, FaultLog& log) noexcept {
  if (sound && has_delay_ && block_[0].xx > 0.0 && block_[1].xx > 0.0) {
    for (std::size_t i = 0; i < 2; ++i) cubic_[i].add(block_[i].cubic(), tick);
    judge_saturation(tick, log);
  }
  jitter_.close_block(sound && has_delay_, tick, log);
  block_ = {};
  if (block_usual_.count() > 0) difference_.add(block_usual_.median(), tick);
  block_usual_.clear();
}

double WheelsetWatch::difference_mps2() const noexcept {
  return kSquareUnitMps2 * std::sqrt(difference_.newest(kNewest).median());
}

void WheelsetWatch::judge_saturation(std::int64_t tick, FaultLog& log) noexcept {
  const auto blocks = static_cast<double>(cubic_[0].size());
  if (cubic_[0].size() < kCubicBlocks) return;
  const std::array<double, 2> c{cubic_[0].median(), cubic_[1].median()};
  const double larger = std::max(std::abs(c[0]), std::abs(c[1]));
  const double smaller = std::min(std::abs(c[0]), std::abs(c[1]));
  if (c[0] * c[1] >= 0.0 || larger < kLeastCubic || smaller < kBothWays * larger) return;
  for (std::size_t i = 0; i < 2; ++i) {
    const double deviation = cubic_[i].scatter() / std::sqrt(blocks);
    if (std::abs(c[i]) < kCubicSignificant * deviation) return;
  }
  // The wheelset that reads too little of what the other shows saturates.
  const FaultChannel channel = c[0] < 0.0 ? FaultChannel::kWheelset2 : FaultChannel::kWheelset1;
  log.report(FaultKind::kSoftSaturation, channel, log.seconds(tick), 100.0 * larger);
}

}  // namespace dampline
