// SPDX-License-Identifier: MIT
#include "sim_hw/noise.hpp"

#include <algorithm>
#include <cmath>

namespace dampline::sim {
namespace {

constexpr std::size_t kStates = 2 * SectionChain::kMaxSections;
constexpr std::size_t kAugmented = kStates + 1;  // the held input is one more state
using Matrix = std::array<std::array<double, kAugmented>, kAugmented>;

Matrix multiply(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (std::size_t i = 0; i < kAugmented; ++i) {
    for (std::size_t k = 0; k < kAugmented; ++k) {
      for (std::size_t j = 0; j < kAugmented; ++j) c[i][j] += a[i][k] * b[k][j];
    }
  }
  return c;
}

/// Taylor series of the exponential; the caller keeps the norm below about 1, 25 terms are exact.
Matrix exponential(const Matrix& a) {
  Matrix sum{};
  Matrix term{};
  for (std::size_t i = 0; i < kAugmented; ++i) sum[i][i] = term[i][i] = 1.0;
  for (int n = 1; n <= 25; ++n) {
    term = multiply(term, a);
    for (std::size_t i = 0; i < kAugmented; ++i) {
      for (std::size_t j = 0; j < kAugmented; ++j) {
        term[i][j] /= n;
        sum[i][j] += term[i][j];
      }
    }
  }
  return sum;
}

}  // namespace

SectionChain::SectionChain(const Section* sections, std::size_t count, double step)
    : count_(std::min(count, kMaxSections)) {
  std::copy_n(sections, count_, sections_.begin());
  constexpr int kHalvings = 6;
  const double part = std::ldexp(step, -kHalvings);
  Matrix a{};
  for (std::size_t i = 0; i < count_; ++i) {
    const std::size_t source = i == 0 ? kStates : 2 * (i - 1);
    a[2 * i][2 * i + 1] = part;
    a[2 * i + 1][2 * i] = -sections_[i].stiffness * part;
    a[2 * i + 1][2 * i + 1] = -sections_[i].damping * part;
    a[2 * i + 1][source] += sections_[i].gain * part;
  }
  Matrix whole = exponential(a);
  for (int i = 0; i < kHalvings; ++i) whole = multiply(whole, whole);
  for (std::size_t i = 0; i < kStates; ++i) {
    for (std::size_t j = 0; j < kStates; ++j) transition_[j][i] = whole[i][j];
    input_[i] = whole[i][kStates] / std::sqrt(step);
  }
}

void SectionChain::advance(double normal) noexcept {
  Vector next{};
  for (std::size_t i = 0; i < kMaxStates; ++i) next[i] = input_[i] * normal;
  for (std::size_t j = 0; j < 2 * count_; ++j) {
    for (std::size_t i = 0; i < kMaxStates; ++i) next[i] += transition_[j][i] * state_[j];
  }
  state_ = next;
  const Section& last = sections_[count_ - 1];
  const double drive = count_ > 1 ? state_[2 * count_ - 4] : 0.0;
  second_derivative_ =
      last.gain * drive - last.damping * first_derivative() - last.stiffness * value();
}

ChainRms stationary_rms(SectionChain chain, std::size_t steps) noexcept {
  ChainRms sum{};
  for (std::size_t n = 0; n < steps; ++n) {
    chain.advance(n == 0 ? 1.0 : 0.0);
    sum.value += chain.value() * chain.value();
    sum.first_derivative += chain.first_derivative() * chain.first_derivative();
    sum.second_derivative += chain.second_derivative() * chain.second_derivative();
  }
  return {std::sqrt(sum.value), std::sqrt(sum.first_derivative), std::sqrt(sum.second_derivative)};
}

}  // namespace dampline::sim
