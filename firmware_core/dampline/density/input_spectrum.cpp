// SPDX-License-Identifier: MIT
#include "dampline/density/input_spectrum.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "dampline/numeric/wide.hpp"

namespace dampline {
namespace {

constexpr double kWindowSquares = 3.0 / 8.0;  // mean of the squares of a Hann window

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

}  // namespace dampline
