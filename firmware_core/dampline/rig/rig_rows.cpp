// SPDX-License-Identifier: MIT
#include "dampline/rig/rig_rows.hpp"

#include <cmath>

namespace dampline {

RigRows::RigRows(const RigConfig& config) noexcept
    : regressors_{config},
      psi_{half_support_samples(config), 1.0 / config.sample_rate_hz},
      still_mps_{config.still_mps},
      stride_{(half_support_samples(config) + 1) / 2} {
  reset();
}

void RigRows::reset() noexcept {
  for (Window& window : windows_) window.open = false;
  until_next_ = 0;
}

void RigRows::open_window() noexcept {
  for (Window& window : windows_) {
    if (window.open) continue;
    window.open = true;
    window.position = -psi_.half();
    window.sum.setZero();
    window.still = 0.0;
    return;
  }
}

void RigRows::add(Window& window, const RigMotion& motion) const noexcept {
  const TestFunction::Values psi = psi_.at(window.position++);
  window.sum += psi.psi * nonlinear_;
  window.sum[rig_column::kInertia] += psi.second * motion.deflection_m;
  window.sum[rig_column::kStiffness] += psi.psi * motion.deflection_m;
  window.sum[rig_column::kViscous] -= psi.first * motion.deflection_m;
  window.sum[rig_column::kForce] += psi.psi * motion.force_n;
  if (std::abs(motion.velocity_mps) < still_mps_) window.still += psi.psi;
}

bool RigRows::update(const RigMotion& motion, RigRow& out) noexcept {
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

}  // namespace dampline
