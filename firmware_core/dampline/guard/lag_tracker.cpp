// SPDX-License-Identifier: MIT
#include "dampline/guard/lag_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dampline {
namespace {

constexpr double kTiny = 1e-300;
constexpr double kLeastCoherence = 0.08;
constexpr double kMostCoherence = 0.98;
constexpr double kReferenceKept = 0.95;  // a block

/// a b, without the checks for infinities of operator*.
LagTracker::Complex times(const LagTracker::Complex& a, const LagTracker::Complex& b) noexcept {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

}  // namespace

double LagTracker::Bin::coherence() const noexcept {
  return std::norm(cross) / (frame * channel + kTiny);
}

int LagTracker::expected_samples() const noexcept {
  return static_cast<int>(std::lround(lag_s_ * rate_hz_));
}

LagTracker::Complex LagTracker::turned(std::size_t k, double lag_s,
                                       const Complex& x) const noexcept {
  const double turn = 2.0 * std::numbers::pi * hz(k) * lag_s;
  return times(x, {std::cos(turn), std::sin(turn)});
}

void LagTracker::start() noexcept {
  adopts_ = !has_reference_;
  coherence_ = phase_ = weight_ = 0.0;
}

LagTracker::Complex LagTracker::whitened(std::size_t k, const Bin& bin) noexcept {
  const double coherence = bin.coherence();
  coherence_ += coherence;
  if (adopts_) return {};
  const Complex product = times(bin.cross, std::conj(reference_[k]));
  return product * (coherence / (std::sqrt(std::norm(product)) + kTiny));
}

void LagTracker::add_phase(std::size_t k, const Bin& bin) noexcept {
  if (adopts_) return;
  const double coherence = std::min(bin.coherence(), kMostCoherence);
  const double weight = coherence / (1.0 - coherence);
  const Complex product = turned(k, static_cast<double>(lag_samples_) / rate_hz_,
                                 times(bin.cross, std::conj(reference_[k])));
  phase_ += weight * hz(k) * phase_of(product);
  weight_ += weight * hz(k) * hz(k);
}

void LagTracker::conclude(double bins_in_band) noexcept {
  valid_ = coherence_ / bins_in_band > kLeastCoherence;
  if (!valid_) return;
  lag_s_ = static_cast<double>(lag_samples_) / rate_hz_;
  if (weight_ > 0.0) lag_s_ -= phase_ / (2.0 * std::numbers::pi * weight_);
  if (adopts_) lag_s_ = 0.0;
}

void LagTracker::learn(std::size_t k, const Bin& bin) noexcept {
  if (!valid_) return;
  has_reference_ = true;
  if (adopts_) reference_[k] = {};
  reference_[k] = kReferenceKept * reference_[k] + turned(k, lag_s_, bin.cross);
}

}  // namespace dampline
