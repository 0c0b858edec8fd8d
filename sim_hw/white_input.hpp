// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

#include "dampline/motion/butterworth.hpp"
#include "dampline/motion/motion.hpp"
#include "sim_hw/noise.hpp"

namespace dampline::sim {

/// y'' + beta y + alpha(v) = eta with beta = 2 k / M, alpha = 2 F / M and eta white: the input that
/// the stationary Fokker-Planck equation supposes, and no track has.
struct WhiteInputConfig {
  std::uint64_t seed{1};
  double moving_mass_kg{37200.0};      ///< M
  double stiffness_npm{5.26e6};        ///< k
  double friction_positive_n{7562.0};  ///< F for v > 0
  double friction_negative_n{9150.0};  ///< -F for v < 0
  double viscous_nspm{0.0};            ///< F holds viscous * v beside the friction
  /// D, two-sided, (m/s^2)^2 / Hz. The default moves the laden truck as good track does that is not
  /// corrugated: 8 mm/s rms.
  double input_level{5.08e-3};
  double settle_s{10.0};  ///< runs before time 0
};

/// Deflection, velocity and accelerations at 300 Hz, true and without sensors; the input passes an
/// anti-alias filter of 100 Hz. Steps of 1 / 9600 s, split symmetrically into restoring force,
/// friction as the set-valued law that it is (an implicit half step cannot overshoot zero), and
/// noise.
class WhiteInput {
 public:
  static constexpr int kStepRateHz = 9600;
  explicit WhiteInput(const WhiteInputConfig& config);
  [[nodiscard]] Motion next();

  [[nodiscard]] static double sample_rate_hz() noexcept { return 300.0; }

 private:
  void step();
  /// After half a step of friction alone.
  [[nodiscard]] double rubbed(double velocity_mps) const noexcept;
  /// Of a sample that friction has stopped: where it was before, about the middle of where it
  /// stops.
  [[nodiscard]] double unresolved() const noexcept;

  double beta_;
  double alpha_positive_mps2_;
  double alpha_negative_mps2_;
  double viscous_ps_;
  double noise_mps2_;  // rms of eta over a step
  Random random_;
  ButterworthLowPass<1> anti_alias_;
  double deflection_m_{0.0};
  double velocity_mps_{0.0};
  double unresolved_mps_{0.0};
  double alpha_mps2_{0.0};
  double input_mps2_{0.0};  // filtered
  std::int64_t tick_{0};
};

/// D for a wanted rms velocity under Coulomb friction: v has the density exp(-2 alpha |v| / D).
[[nodiscard]] double input_level_for(double velocity_rms_mps, double friction_n,
                                     double moving_mass_kg) noexcept;

}  // namespace dampline::sim
