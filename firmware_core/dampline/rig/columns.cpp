// SPDX-License-Identifier: MIT
#include "dampline/rig/columns.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>

namespace dampline::rig {
namespace {

/// Central differences, Fornberg, Mathematics of Computation 51 (1988) 699, table 1.
constexpr std::array<double, 4> kFirst{0.0, 3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0};
constexpr std::array<double, 4> kSecond{-49.0 / 18.0, 3.0 / 2.0, -3.0 / 20.0, 1.0 / 90.0};

}  // namespace

std::array<double, kCurveSegments> ramps(double speed,
                                         const std::array<double, kCurveSegments>& nodes) noexcept {
  std::array<double, kCurveSegments> out{};
  double start = 0.0;
  for (std::size_t i = 0; i < kCurveSegments; ++i) {
    const bool last = i + 1 == kCurveSegments;
    const double end = last || speed < nodes[i] ? speed : nodes[i];
    out[i] = end > start ? end - start : 0.0;
    start = nodes[i];
  }
  return out;
}

void Regressors::fill_branch(bool positive, double speed_mps, Block::Row& row) const noexcept {
  row[column::kSign] = positive ? 1.0 : -1.0;
  row[column::kOne] = 1.0;
  const auto parts = ramps(speed_mps, nodes_);
  const int first = positive ? column::kRampPositive : column::kRampNegative;
  for (std::size_t i = 0; i < kCurveSegments; ++i)
    row[first + static_cast<int>(i)] = positive ? parts[i] : -parts[i];
}

void Regressors::fill(const Motion& motion, Block::Row& row) const noexcept {
  fill_branch(motion.velocity_mps > 0.0, std::abs(motion.velocity_mps), row);
  row[column::kSign] =
      sign_.mean(motion.velocity_before_mps, motion.velocity_mps, motion.velocity_after_mps);
}

TestFunction::TestFunction(int half, double interval_s) noexcept
    : half_{half}, interval_s_{interval_s} {
  double sum = 0.0;
  for (int j = -half; j <= half; ++j) sum += psi(j);
  norm_ = 1.0 / sum;
}

double TestFunction::psi(int j) const noexcept {
  const int end = half_ - kDifference + 1;  // psi is 0 from here on, its differences three later
  if (std::abs(j) >= end) return 0.0;
  const double u = static_cast<double>(j) / end;
  const double q = 1.0 - u * u;
  return norm_ * q * q * q * q * q;
}

TestFunction::Values TestFunction::at(int j) const noexcept {
  Values out{psi(j), 0.0, kSecond[0] * psi(j)};
  for (int m = 1; m <= kDifference; ++m) {
    const auto i = static_cast<std::size_t>(m);
    const double before = psi(j - m);
    const double after = psi(j + m);
    out.first += kFirst[i] * (after - before);
    out.second += kSecond[i] * (after + before);
  }
  out.first /= interval_s_;
  out.second /= interval_s_ * interval_s_;
  return out;
}

double TestFunction::second_noise_gain() const noexcept {
  double sum = 0.0;
  for (int j = -half_; j <= half_; ++j) {
    const double second = at(j).second;
    sum += second * second;
  }
  return std::sqrt(sum);
}

Rows::Rows(const Config& config) noexcept
    : regressors_{config},
      psi_{half_support_samples(config), 1.0 / config.sample_rate_hz},
      still_mps_{config.still_mps},
      stride_{(half_support_samples(config) + 1) / 2} {
  reset();
}

void Rows::reset() noexcept {
  for (Window& window : windows_) window.open = false;
  until_next_ = 0;
}

void Rows::open_window() noexcept {
  for (Window& window : windows_) {
    if (window.open) continue;
    window.open = true;
    window.position = -psi_.half();
    window.sum.setZero();
    window.still = 0.0;
    return;
  }
}

void Rows::add(Window& window, const Motion& motion) const noexcept {
  const TestFunction::Values psi = psi_.at(window.position++);
  window.sum += psi.psi * nonlinear_;
  window.sum[column::kInertia] += psi.second * motion.deflection_m;
  window.sum[column::kStiffness] += psi.psi * motion.deflection_m;
  window.sum[column::kViscous] -= psi.first * motion.deflection_m;
  window.sum[column::kForce] += psi.psi * motion.force_n;
  if (std::abs(motion.velocity_mps) < still_mps_) window.still += psi.psi;
}

bool Rows::update(const Motion& motion, Row& out) noexcept {
  if (until_next_ == 0) {
    open_window();
    until_next_ = stride_;
  }
  --until_next_;
  nonlinear_.setZero();
  regressors_.fill(motion, nonlinear_);
  bool complete = false;
  for (Window& window : windows_) {
    if (!window.open) continue;
    add(window, motion);
    if (window.position <= psi_.half()) continue;
    window.open = false;
    out = {motion.tick - psi_.half(), window.sum, window.still};
    complete = true;
  }
  return complete;
}

}  // namespace dampline::rig
