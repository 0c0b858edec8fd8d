// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "dampline/basis/window_bank.hpp"
#include "dampline/effect/effect_laws.hpp"
#include "dampline/effect/gram.hpp"
#include "dampline/effect/raw_ring.hpp"

namespace dampline::effect {

/// Galerkin rows of all candidate columns, by the windows of the base estimate.
class EffectRows {
 public:
  using Sampled = Eigen::Matrix<float, kSampledColumns, 1>;

  explicit EffectRows(double sample_rate_hz) noexcept;

  [[nodiscard]] const WindowBank& bank() const noexcept { return bank_; }

  /// The averaged columns at a tick, and whether the truck stood still then.
  void set(std::int64_t tick, const Sampled& values, bool still) noexcept {
    values_[index(tick)] = values;
    still_[index(tick)] = still ? 1.0F : 0.0F;
  }

  [[nodiscard]] const Sampled& values(std::int64_t tick) const noexcept {
    return values_[index(tick)];
  }

  /// The row of a scale centred on a tick. Needs the columns at tick - half...tick + half and the
  /// accelerations one further on each side.
  [[nodiscard]] Row row(std::size_t scale, std::int64_t tick, const RawRing& raw) const noexcept;
  /// Share of the row's weight that lies on samples at a standstill, 0...1.
  [[nodiscard]] double still_share(std::size_t scale, std::int64_t tick) const noexcept;

 private:
  static constexpr std::size_t kRing = 2 * static_cast<std::size_t>(WindowBank::kMaxHalf) + 2;
  static constexpr std::size_t kRateTable = 1104;
  static std::size_t index(std::int64_t tick) noexcept {
    return static_cast<std::size_t>(tick) % kRing;
  }
  void linear(std::size_t scale, std::int64_t tick, const RawRing& raw, Row& row) const noexcept;

  WindowBank bank_;
  std::array<std::size_t, kScales> rate_start_{};
  std::array<double, kRateTable> lumped_rate_{};  // psi' at -half-1...half+1, by scale
  std::array<Sampled, kRing> values_{};
  std::array<float, kRing> still_{};
};

}  // namespace dampline::effect
