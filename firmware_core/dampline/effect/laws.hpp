// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <array>

#include "dampline/effect/columns.hpp"
#include "dampline/effect/grids.hpp"
#include "dampline/effect/modes.hpp"

namespace dampline::effect {

/// A value and its rate.
struct Slope {
  double value{0.0};
  double rate{0.0};
};

/// The motion at one sample, each part with its rate of change.
struct Instant {
  Slope deflection_m;
  Slope velocity_mps;
  Slope wheelset1_mps;  ///< z_1', without drift
  Slope wheelset2_mps;
  double turn_mps2{0.0};  ///< -(z_1'' - z_2'') / 2, what makes the frame pitch
};

/// The motion between samples.
struct Point {
  double deflection_m{0.0};
  double velocity_mps{0.0};
  double wheelset1_mps{0.0};
  double wheelset2_mps{0.0};
  double wheelset1_mps2{0.0};
  double wheelset2_mps2{0.0};
  double turn_mps2{0.0};
};

/// Weights of the cubic Hermite polynomial at one place between two samples.
struct Hermite {
  double left, left_rate, right, right_rate, place;

  [[nodiscard]] static constexpr Hermite at(double u, double step_s) noexcept {
    const double r = 1.0 - u;
    return {(1.0 + 2.0 * u) * r * r, step_s * u * r * r, u * u * (3.0 - 2.0 * u),
            -step_s * u * u * r, u};
  }
  [[nodiscard]] constexpr double operator()(const Slope& a, const Slope& b) const noexcept {
    return left * a.value + left_rate * a.rate + right * b.value + right_rate * b.rate;
  }
  [[nodiscard]] Point operator()(const Instant& a, const Instant& b) const noexcept {
    Point p;
    p.deflection_m = (*this)(a.deflection_m, b.deflection_m);
    p.velocity_mps = (*this)(a.velocity_mps, b.velocity_mps);
    p.wheelset1_mps = (*this)(a.wheelset1_mps, b.wheelset1_mps);
    p.wheelset2_mps = (*this)(a.wheelset2_mps, b.wheelset2_mps);
    p.wheelset1_mps2 = (1.0 - place) * a.wheelset1_mps.rate + place * b.wheelset1_mps.rate;
    p.wheelset2_mps2 = (1.0 - place) * a.wheelset2_mps.rate + place * b.wheelset2_mps.rate;
    p.turn_mps2 = (1.0 - place) * a.turn_mps2 + place * b.turn_mps2;
    return p;
  }
};

inline constexpr double kEngagedOver = 0.1;  ///< of a gap: where the force of a taken-up one rises

/// Values of the columns that are functions of the motion; single precision, since they are
/// projected on thousands of windows and never differenced.
using LawValues = Eigen::Matrix<float, kLawColumns, 1>;

/// Every candidate law as a regressor over the motion and its history. Lengths are multiples of
/// the size of the deflection.
class Laws {
 public:
  /// Precondition: grids.scale_m > 0.
  Laws(const Grids& grids, double step_s) noexcept;

  /// The columns at a point; points come in the order of time, `step_s` apart, since some laws
  /// remember.
  [[nodiscard]] LawValues operator()(const Point& point) noexcept;
  /// Forgets the history.
  void reset() noexcept;
  [[nodiscard]] const Grids& grids() const noexcept { return grids_; }

 private:
  void friction(const Point& point, LawValues& out) const noexcept;
  void stiffness(double deflection_m, LawValues& out) const noexcept;
  void memory(const Point& point, LawValues& out) noexcept;
  void relax(double step_m, LawValues& out) noexcept;

  Grids grids_;
  bool any_{false};
  double last_deflection_m_{0.0};
  std::array<double, kDahlDistances> zeta_{};
  std::array<double, kBacklashGaps> piston_m_{};
  std::array<double, kRelaxations> stretch_m_{};
  std::array<double, kRelaxations> kept_{};   // of a stretch, over one step
  std::array<double, kRelaxations> taken_{};  // of a step's way
  PitchBank pitch_;
};

/// The laws between samples: motion by the cubic Hermite polynomial, laws at four points a sample,
/// each column averaged by the hat function of two samples' width (as the base law's, LawAverage).
class LawMean {
 public:
  LawMean(const Grids& grids, double step_s) noexcept
      : laws_{grids, 0.25 * step_s},
        quarter_{Hermite::at(0.25, step_s)},
        half_{Hermite::at(0.5, step_s)},
        three_quarters_{Hermite::at(0.75, step_s)} {}

  /// Takes the motion at sample n; returns the averages at n - 1, meaningful once complete().
  LawValues update(const Instant& instant) noexcept {
    const Hermite start = Hermite::at(0.0, 0.0);
    const LawValues p0 = laws_(start(last_, instant));
    const LawValues p1 = laws_(quarter_(last_, instant));
    const LawValues p2 = laws_(half_(last_, instant));
    const LawValues p3 = laws_(three_quarters_(last_, instant));
    LawValues mean = from_left_ + (4.0F * p0 + 3.0F * p1 + 2.0F * p2 + p3) / 16.0F;
    from_left_ = (p1 + 2.0F * p2 + 3.0F * p3) / 16.0F;
    last_ = instant;
    ++count_;
    return mean;
  }
  [[nodiscard]] bool complete() const noexcept { return count_ >= 3; }
  void reset(const Instant& first) noexcept {
    laws_.reset();
    last_ = first;
    from_left_.setZero();
    count_ = 0;
  }
  [[nodiscard]] const Grids& grids() const noexcept { return laws_.grids(); }

 private:
  Laws laws_;
  Hermite quarter_, half_, three_quarters_;
  Instant last_{};
  LawValues from_left_ = LawValues::Zero();
  int count_{0};
};

}  // namespace dampline::effect
