// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>

#include "dampline/rig/rig_columns.hpp"
#include "dampline/rig/rig_test_function.hpp"

namespace dampline {

/// One equation: the test function against every column and the force, in newtons.
struct RigRow {
  std::int64_t centre_tick{0};
  RigInformation::Row row;
  double still_share{0.0};  ///< weight of the test function on standstill
};

/// Galerkin rows of m x'' + c x' + k x + ... = f by integration by parts,
///   <x'', psi> = <x, psi''>,  <x', psi> = -<x, psi'>,
/// so that no noisy derivative of the deflection enters a linear term. One row every half of a half
/// support. Each open window adds its share of every sample: no history, constant time per sample.
class RigRows {
 public:
  explicit RigRows(const RigConfig& config) noexcept;

  /// Consecutive motion. True when `out` was filled.
  bool update(const RigMotion& motion, RigRow& out) noexcept;
  /// Drops the open windows: what they hold cannot be completed.
  void reset() noexcept;
  [[nodiscard]] int half() const noexcept { return psi_.half(); }

 private:
  static constexpr std::size_t kOpen = 6;

  struct Window {
    bool open{false};
    int position{0};
    RigInformation::Row sum;
    double still{0.0};
  };

  void open_window() noexcept;
  void add(Window& window, const RigMotion& motion) const noexcept;

  RigRegressors regressors_;
  TestFunction psi_;
  double still_mps_;
  int stride_;
  int until_next_{0};
  RigInformation::Row nonlinear_;
  std::array<Window, kOpen> windows_{};
};

}  // namespace dampline
