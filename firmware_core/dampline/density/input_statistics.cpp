// SPDX-License-Identifier: MIT
#include "dampline/density/input_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "dampline/numeric/blocks.hpp"
#include "dampline/numeric/cholesky.hpp"
#include "dampline/numeric/wide.hpp"

namespace dampline {
namespace {

constexpr double kWindowSquares = 3.0 / 8.0;  // mean of the squares of a Hann window

constexpr std::size_t kQuarters = 4;
constexpr std::size_t kFewest = 8;
constexpr double kMemories = 3.0;

}  // namespace

void InputSpectrum::Sums::add(const Sums& other, double factor) noexcept {
  for (std::size_t k = 0; k < kLines; ++k) power[k] += factor * other.power[k];
  weight += factor * other.weight;
}

InputSpectrum::InputSpectrum(double sample_rate_hz) noexcept : sample_rate_hz_{sample_rate_hz} {
  constexpr double kTurn = 2.0 * std::numbers::pi / static_cast<double>(kLength);
  for (std::size_t k = 0; k < kLinesUsed; ++k) {
    const double turn = kTurn * static_cast<double>(k + kFirstLine - 1);
    cosine_[k] = std::cos(turn);
    sine_[k] = std::sin(turn);
  }
}

DAMPLINE_WIDE void InputSpectrum::update(double x, double weight, Sums& sums) noexcept {
  for (std::size_t k = 0; k < kLinesUsed; k += 4) {
    const Wide last = wide(&last_[k]).numbers;
    const Wide next = x + 2.0 * wide(&cosine_[k]).numbers * last - wide(&before_[k]).numbers;
    wide(&before_[k]).numbers = last;
    wide(&last_[k]).numbers = next;
  }
  if (++place_ == kHop) end_half(weight, sums);
}

// Goertzel's states s_N, s_(N-1) after N samples give sum x_n e^(-i w n) = e^(-i w (N-1)) (s_N -
// e^(-i w) s_(N-1)); here w N is half as many turns as the line's number: e^(-i w N) = (-1)^line.
void InputSpectrum::end_half(double weight, Sums& sums) noexcept {
  Half both;  // the transform of 512, if there was a half before
  Half second;
  for (std::size_t k = 0; k < kLinesUsed; ++k) {
    const double sign = (k + kFirstLine - 1) % 2 == 0 ? 1.0 : -1.0;
    // (-1)^line e^(i w) (s_N - e^(-i w) s_(N-1)) = (-1)^line (e^(i w) s_N - s_(N-1))
    second.real[k] = sign * (cosine_[k] * last_[k] - before_[k]);
    second.imaginary[k] = sign * sine_[k] * last_[k];
    both.real[k] = first_.real[k] + sign * second.real[k];
    both.imaginary[k] = first_.imaginary[k] + sign * second.imaginary[k];
  }
  first_ = second;
  last_.fill(0.0);
  before_.fill(0.0);
  place_ = 0;
  if (!std::exchange(has_first_, true)) return;
  const double scale = weight / (sample_rate_hz_ * kWindowSquares * static_cast<double>(kLength));
  // The window 1/2 - 1/2 cos(2 pi (n + 1/2) / 512) is symmetric about the samples' middle: its
  // neighbours turn by half a sample. cosine_[0] and sine_[0] are of one whole.
  const double half_cosine = std::sqrt(0.5 * (1.0 + cosine_[0]));
  const double half_sine = std::sqrt(0.5 * (1.0 - cosine_[0]));
  for (std::size_t k = 0; k < kLines; ++k) {
    const double real =
        0.5 * both.real[k + 1] - 0.25 * (half_cosine * (both.real[k] + both.real[k + 2]) +
                                         half_sine * (both.imaginary[k + 2] - both.imaginary[k]));
    const double imaginary = 0.5 * both.imaginary[k + 1] -
                             0.25 * (half_cosine * (both.imaginary[k] + both.imaginary[k + 2]) +
                                     half_sine * (both.real[k] - both.real[k + 2]));
    sums.power[k] += scale * (real * real + imaginary * imaginary);
  }
  sums.weight += weight;
}

void InputSpectrum::reset() noexcept {
  last_.fill(0.0);
  before_.fill(0.0);
  place_ = 0;
  has_first_ = false;
}

void Modulation::add(const Modulation& other, double factor) noexcept {
  for (std::size_t m = 0; m < kMoments; ++m) moments_[m] += factor * other.moments_[m];
  for (std::size_t m = 0; m < kTerms; ++m) squares_[m] += factor * other.squares_[m];
}

void Modulation::scale(double factor) noexcept {
  for (double& moment : moments_) moment *= factor;
  for (double& square : squares_) square *= factor;
}

Modulation::Polynomial Modulation::shape() const noexcept {
  constexpr int kSize = static_cast<int>(kTerms);
  Cholesky<kSize>::Matrix gram;
  Cholesky<kSize>::Vector right;
  for (std::size_t i = 0; i < kTerms; ++i) {
    for (std::size_t j = 0; j < kTerms; ++j) {
      gram(static_cast<int>(i), static_cast<int>(j)) = moments_[i + j];
    }
    right[static_cast<int>(i)] = squares_[i];
  }
  Polynomial out{1.0};
  Cholesky<kSize> cholesky;
  if (!(squares_[0] > 0.0) || !cholesky.factor(gram, kSize)) return out;
  cholesky.solve(right);
  const double mean = squares_[0] / moments_[0];
  for (std::size_t i = 0; i < kTerms; ++i) out[i] = right[static_cast<int>(i)] / mean;
  return out;
}

double Modulation::at(const Polynomial& shape, double deflection_m) noexcept {
  const double y = 1.0e3 * deflection_m;
  double sum = 0.0;
  for (std::size_t i = kTerms; i > 0; --i) sum = sum * y + shape[i - 1];
  return std::max(sum, 0.0);
}

void BlockPowers::Power::add(const Power& other) noexcept {
  motion += other.motion;
  input += other.input;
  count += other.count;
}

BlockPowers::BlockPowers(double memory_blocks) noexcept : rings_{memory_blocks > 0.0} {
  if (!rings_) return;
  const double blocks = std::ceil(kMemories * memory_blocks / static_cast<double>(kSlots));
  blocks_per_slot_ = static_cast<std::uint32_t>(std::clamp(blocks, 1.0, 1.0e9));
}

void BlockPowers::close_block() noexcept {
  if (open_.count == 0.0) return;
  ++blocks_;
  end_slot();
}

void BlockPowers::end_slot() noexcept {
  if (blocks_ < blocks_per_slot_) return;
  push(open_);
  open_ = {};
  blocks_ = 0;
}

void BlockPowers::push(const Power& slot) noexcept {
  if (size_ == kSlots && rings_) {
    slots_[oldest_] = slot;
    oldest_ = (oldest_ + 1) % kSlots;
    return;
  }
  slots_[size_++] = slot;
  if (size_ == kSlots && !rings_) coarsen();
}

void BlockPowers::coarsen() noexcept {
  if (size_ % 2 == 1) {
    open_.add(slots_[--size_]);
    blocks_ += blocks_per_slot_;
  }
  size_ = join_neighbours(slots_, size_, [](Power& slot, const Power& next) { slot.add(next); });
  blocks_per_slot_ *= 2;
}

void BlockPowers::append(const BlockPowers& other) noexcept {
  BlockPowers tail = other;
  if (!rings_) {
    while (tail.blocks_per_slot_ < blocks_per_slot_) tail.coarsen();
    while (blocks_per_slot_ < tail.blocks_per_slot_) coarsen();
    while (size_ + tail.size_ >= kSlots) {
      coarsen();
      tail.coarsen();
    }
  }
  for (std::size_t i = 0; i < tail.size_; ++i) push(tail.slots_[(tail.oldest_ + i) % kSlots]);
  open_.add(tail.open_);
  blocks_ += tail.blocks_;
  end_slot();
}

BlockPowers::Change BlockPowers::change_of(double Power::*power) const noexcept {
  Change out;
  if (size_ < kFewest) return out;
  double sum = 0.0;
  double squares = 0.0;
  double count = 0.0;
  std::array<Power, kQuarters> quarters{};
  for (std::size_t i = 0; i < size_; ++i) {
    const Power& slot = slots_[(oldest_ + i) % kSlots];
    const double mean = slot.*power / slot.count;
    sum += mean;
    squares += mean * mean;
    count += 1.0;
    quarters[kQuarters * i / size_].add(slot);
  }
  const double mean = sum / count;
  if (!(mean > 0.0)) return out;
  out.known = true;
  const double variance = std::max(squares / count - mean * mean, 0.0);
  out.chance = std::sqrt(variance * static_cast<double>(kQuarters) / count) / mean;
  for (const Power& quarter : quarters) {
    const double ratio = quarter.*power / (quarter.count * mean);
    out.size = std::max(out.size, ratio > 0.0 ? std::abs(std::log(ratio)) : 1.0e3);
  }
  return out;
}

BlockPowers::Change BlockPowers::change() const noexcept {
  const Change motion = change_of(&Power::motion);
  const Change input = change_of(&Power::input);
  return motion.size - motion.chance > input.size - input.chance ? motion : input;
}

}  // namespace dampline
