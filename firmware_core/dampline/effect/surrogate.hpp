// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "dampline/motion/butterworth.hpp"
#include "dampline/numeric/random.hpp"
#include "dampline/sample.hpp"

namespace dampline::effect {

/// Friction that remembers where the motion turned: none over the gap (play), or building up over
/// the length (Dahl).
struct FrictionMemory {
  bool is_play{false};
  double force_mps2{0.0};  ///< per unit of mass, in steady sliding; 0: none
  double length_m{0.0};    ///< of a play: to where half the force is there
  double width_mps{0.0};   ///< of a play: PlayShape
};

/// What else was found of the suspension's force, per unit of mass. Zeros: nothing.
struct FoundForce {
  double viscous_up_per_s{0.0};  ///< for v > 0
  double viscous_down_per_s{0.0};
  double quadratic_per_m{0.0};  ///< times v |v|
  double grows_per_m{0.0};      ///< the level of friction, of itself, with y ...
  double widens_per_m{0.0};     ///< ... with |y|
  double falls_mps2{0.0};       ///< friction at rest above its level, times exp(-|v| / falls_over)
  double falls_over_mps{1.0};
  double square_per_m_s2{0.0};   ///< times y^2
  double cube_per_m2_s2{0.0};    ///< times y^3
  double magnitude_per_s2{0.0};  ///< times |y|
  double stop_up_per_s2{0.0};    ///< beyond y = stop_m
  double stop_down_per_s2{0.0};  ///< beyond y = -stop_m
  double stop_m{0.0};
  double relaxing_per_s2{0.0};  ///< a spring behind a dashpot
  double relaxing_s{1.0};
  friend bool operator==(const FoundForce&, const FoundForce&) = default;
};

/// The law and the sensors, as a record tells them.
struct SurrogateConfig {
  double sample_rate_hz{300.0};
  double coulomb_mps2{0.0};      ///< F / M
  double stiffness_per_s2{0.0};  ///< k / M
  double viscous_per_s{0.0};     ///< c / M
  FrictionMemory memory{};
  FoundForce found{};
  double input_low_pass_hz{0.0};                 ///< of the record's wheelsets; 0: none
  double low_pass_hz{0.0};                       ///< that it is seen through; 0: none
  std::array<double, kChannels> noise_mps2{};    ///< rms, what the resolution makes included
  std::array<double, kChannels> step_mps2{};     ///< resolution; 0: unknown
  std::array<double, kChannels> bridged_mps2{};  ///< error of values that were put in, rms
  std::uint64_t seed{1987};                      ///< of the noise
};

/// The record that a law alone would have made: M z_b'' + k y + c v + F sign v = 0, friction with
/// memory and what else was found, on the measured motion of the wheelsets, seen by the same
/// sensors. What the estimate leaves of it is the floor that no effect can take away.
class Surrogate {
 public:
  explicit Surrogate(const SurrogateConfig& config);
  /// Takes a sample; the surrogate's of the one before, where there is one. Samples that are no
  /// number stay that, and a gap starts the motion anew.
  [[nodiscard]] std::optional<Sample> next(const Sample& sample);

 private:
  struct Motion {
    double deflection_m{0.0};
    double velocity_mps{0.0};
    double zeta{0.0};       // of Dahl's law
    double stretch_m{0.0};  // of the relaxing spring
  };
  [[nodiscard]] double frame_mps2(const Motion& m) const noexcept;
  [[nodiscard]] double remembered(const Motion& m) const noexcept;
  [[nodiscard]] double elastic_mps2(const Motion& m) const noexcept;
  [[nodiscard]] double friction_mps2(const Motion& m) const noexcept;
  [[nodiscard]] Motion rate(const Motion& m, double input_mps2) const noexcept;
  void step(double from_mps2, double to_mps2, double step_s) noexcept;
  [[nodiscard]] std::array<double, 2> between(int part) const noexcept;
  [[nodiscard]] Sample seen(const std::array<double, kChannels>& accel_mps2);
  void set_taps();
  void restart() noexcept;

  static constexpr int kFine = 8;   // steps a sample
  static constexpr int kHalf = 24;  // samples to either side that tell what is between two
  static constexpr std::size_t kTaps = 2 * static_cast<std::size_t>(kHalf);

  SurrogateConfig config_;
  bool finds_;
  double ramp_m_;
  std::array<std::array<double, kTaps>, kFine + 1> taps_{};
  int parts_{1};  // of the law's steepest slope, in each fine step
  ButterworthLowPass<kChannels> filter_;
  Random noise_;
  std::array<double, kChannels> white_mps2_{};
  std::array<Sample, kTaps> held_{};  // oldest first
  std::size_t count_{0};
  Motion motion_{};
  double piston_m_{0.0};  // in its play
};

}  // namespace dampline::effect
