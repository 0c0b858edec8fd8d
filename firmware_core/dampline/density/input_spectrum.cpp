// SPDX-License-Identifier: MIT
#include "dampline/density/input_spectrum.hpp"

#include <cmath>
#include <numbers>

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
  for (std::size_t k = 0; k < kLines; ++k) {
    twice_cosine_[k] = 2.0 * std::cos(kTurn * static_cast<double>(k + kFirstLine));
  }
  for (std::size_t n = 0; n < kHop; ++n) {
    window_[n] = 0.5 - 0.5 * std::cos(kTurn * (static_cast<double>(n) + 0.5));
  }
}

void InputSpectrum::update(double x, double weight, Sums& sums) noexcept {
  push(banks_[0], x, weight, sums);
  if (banks_[0].place == kHop) second_runs_ = true;
  if (second_runs_) push(banks_[1], x, weight, sums);
}

void InputSpectrum::push(Bank& bank, double x, double weight, Sums& sums) noexcept {
  const std::size_t n = bank.place < kHop ? bank.place : kLength - 1 - bank.place;
  const double windowed = window_[n] * x;
  for (std::size_t k = 0; k < kLines; ++k) {
    const double next = windowed + twice_cosine_[k] * bank.last[k] - bank.before[k];
    bank.before[k] = bank.last[k];
    bank.last[k] = next;
  }
  if (++bank.place < kLength) return;
  const double scale = weight / (sample_rate_hz_ * kWindowSquares * static_cast<double>(kLength));
  for (std::size_t k = 0; k < kLines; ++k) {
    const double a = bank.last[k];
    const double b = bank.before[k];
    sums.power[k] += scale * (a * a + b * b - twice_cosine_[k] * a * b);
  }
  sums.weight += weight;
  bank = Bank{};
}

void InputSpectrum::reset() noexcept {
  banks_.fill(Bank{});
  second_runs_ = false;
}

}  // namespace dampline
