// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "dampline/basis/columns.hpp"
#include "dampline/basis/window_bank.hpp"

namespace dampline {

/// The friction law between samples. Velocity is interpolated by the cubic Hermite polynomial of
/// velocities and measured accelerations, the law is evaluated at four points a sample, and each
/// column is averaged by the hat function of two samples' width, [1 2 3 4 3 2 1] / 16: the exact
/// inner product with a piecewise linear test function. On the samples alone a sign would alias
/// and bias the friction level by about one percent.
class LawAverage {
 public:
  using Lanes = LawColumns::Lanes;

  /// Takes velocity and acceleration (dv/dt) at sample n; returns the averages at n - 1, meaningful
  /// from the third call after reset().
  Lanes update(const LawColumns& law, double velocity_mps, double accel_mps2,
               double step_s) noexcept;

  /// True when the value returned last was an average over both neighbours.
  [[nodiscard]] bool complete() const noexcept { return count_ >= 3; }
  void reset() noexcept { count_ = 0; }

 private:
  double last_velocity_mps_{0.0};
  double last_accel_mps2_{0.0};
  Lanes from_left_ = Lanes::Zero();
  int count_{0};
};

/// The law's columns as they wait for their rows: as they are, or in 16 bits each. Then a sign is
/// good to 1e-5 and a ramp, at most 0.25 m/s, to 2e-6 m/s, rms: a hundredth of the velocity's
/// noise.
template <class Number>
class LawRing {
 public:
  using Stored = std::array<Number, static_cast<std::size_t>(LawColumns::kLanes)>;
  static Stored stored(const LawColumns::Lanes& lanes) noexcept {
    Stored out;
    for (int i = 0; i < LawColumns::kLanes; ++i)
      if constexpr (kIsWhole)
        out[static_cast<std::size_t>(i)] =
            static_cast<Number>(std::lround(std::clamp(lanes[i] / step(i), -kMost, kMost)));
      else
        out[static_cast<std::size_t>(i)] = lanes[i];
    return out;
  }
  /// What a sum of stored numbers is multiplied by, in its lane.
  static constexpr float step(int lane) noexcept {
    if (!kIsWhole) return 1.0F;
    return (lane < LawColumns::kSignLanes ? 1.0F : 0.25F) / kMost;
  }

 private:
  static constexpr bool kIsWhole = std::is_integral_v<Number>;
  static constexpr float kMost = 32767.0F;
};

/// How a builder keeps what waits for its rows.
struct FullRows {
  using Number = double;
  using Law = float;
  static constexpr int kMostHz = 400;
  static constexpr std::size_t kRawRing = 2048;
};
struct SmallRows {
  using Number = float;
  using Law = std::int16_t;
  static constexpr int kMostHz = 300;
  static constexpr std::size_t kRawRing = 1024;
};

/// Galerkin rows from a stretch of samples without gaps. Samples are numbered from 0 in a stretch;
/// accelerations come first, the law's columns of the same sample some seconds later.
template <class Keeps>
class BasicRowBuilder {
 public:
  using Bank = BasicWindowBank<typename Keeps::Number, Keeps::kMostHz>;
  explicit BasicRowBuilder(double sample_rate_hz) noexcept : bank_{sample_rate_hz} {}

  [[nodiscard]] const Bank& bank() const noexcept { return bank_; }

  /// Accelerations of sample n: z_b'' and y'' = 2 z_b'' - z_1'' - z_2''.
  void set_accelerations(std::int64_t n, double frame_mps2, double relative_mps2) noexcept {
    frame_mps2_[raw(n)] = static_cast<Number>(frame_mps2);
    relative_mps2_[raw(n)] = static_cast<Number>(relative_mps2);
  }

  /// Of the last kRawRing samples.
  [[nodiscard]] double frame_mps2(std::int64_t n) const noexcept { return frame_mps2_[raw(n)]; }
  [[nodiscard]] double relative_mps2(std::int64_t n) const noexcept {
    return relative_mps2_[raw(n)];
  }

  /// The law's columns at sample n, and whether the truck stood still then.
  void set_law(std::int64_t n, const LawColumns::Lanes& values, bool still) noexcept {
    law_[law(n)] = Ring::stored(values);
    still_[law(n)] = still ? 1.0F : 0.0F;
    if (still) newest_still_ = n;
  }

  /// The row of a scale centred on sample n. Needs the law at n - half...n + half and
  /// the accelerations at n - half - 1...n + half + 1. Cost: half (kLanes + 6) multiplications. The
  /// law's columns are sums in single precision: 1e-6 of a column's norm.
  [[nodiscard]] GalerkinRow row(std::size_t scale, std::int64_t n) const noexcept;
  /// Share of the row's weight that lies on samples at a standstill, 0...1.
  [[nodiscard]] double still_share(std::size_t scale, std::int64_t n) const noexcept;

 private:
  /// The law's columns, by pairs of samples at equal distance from the centre: psi is even.
  [[nodiscard]] LawColumns::Lanes law_columns(std::size_t scale, std::int64_t n) const noexcept;
  /// Stiffness, viscous, target.
  [[nodiscard]] Eigen::Vector3d linear_columns(std::size_t scale, std::int64_t n) const noexcept;

  using Number = typename Keeps::Number;
  using Ring = LawRing<typename Keeps::Law>;
  static constexpr std::size_t kRawRing = Keeps::kRawRing;
  static constexpr std::size_t kLawRing = 2 * static_cast<std::size_t>(Bank::kMaxHalf) + 2;
  static std::size_t raw(std::int64_t n) noexcept {
    return static_cast<std::size_t>(n) & (kRawRing - 1);
  }
  static std::size_t law(std::int64_t n) noexcept { return static_cast<std::size_t>(n) % kLawRing; }

  Bank bank_;
  std::array<Number, kRawRing> frame_mps2_{};
  std::array<Number, kRawRing> relative_mps2_{};
  std::array<typename Ring::Stored, kLawRing> law_{};
  std::array<float, kLawRing> still_{};
  std::int64_t newest_still_{-1};  // of an earlier stretch perhaps; then too large at worst
};

using RowBuilder = BasicRowBuilder<FullRows>;

}  // namespace dampline
