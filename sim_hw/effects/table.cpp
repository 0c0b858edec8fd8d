// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>

#include "sim_hw/effects/registry.hpp"

namespace dampline::sim {
namespace {

/// Fc = (F1 + F2) / 2 of a car.
double coulomb_level_n(const SimulationConfig& config) noexcept {
  const TruckConfig& truck = config.truck;
  return 0.5 * truck.friction_scale * (truck.friction_positive_n + truck.friction_negative_n);
}

/// How far a car's deflection reaches compared with the laden car's.
double reach(const SimulationConfig& config) noexcept {
  return config.truck.moving_mass_kg > 20000.0 ? 1.0 : 2.0 / 3.0;
}

/// A nominal value that is the same for every car.
template <int Millionths>
double fixed(const SimulationConfig& /*config*/) noexcept {
  return Millionths * 1e-6;
}

template <auto Group, auto Member>
void set_truck(SimulationConfig& config, double value) {
  config.truck.*Group.*Member = value;
}

template <auto Member>
void set_impulse(SimulationConfig& config, double value) {
  config.impulses.*Member = value;
}

template <auto Member, std::size_t Index>
void set_sensor(SimulationConfig& config, double value) {
  (config.sensors.*Member)[Index] = value;
}

constexpr double kTypicalSpeedMps = 0.018;

/// A quarter of the Coulomb level at the speed that is typical on the track.
double viscous_nspm(const SimulationConfig& config) noexcept {
  return 0.25 * coulomb_level_n(config) / kTypicalSpeedMps;
}

/// The deflection at which the nominal nonlinear part is 15 % of the linear one.
double typical_m(const SimulationConfig& config) noexcept { return 1.6e-3 * reach(config); }

/// The simulation keeps a short past only.
double skew_s(double wanted_s) noexcept { return std::clamp(wanted_s, -0.02, 0.02); }

constexpr std::array<EffectParameter, 1> kViscous{
    {{"coefficient_nspm", Domain::kNotNegative, Strength::kTimes, viscous_nspm,
      [](SimulationConfig& config, double value) {
        config.truck.damping.viscous_positive_nspm = config.truck.damping.viscous_negative_nspm =
            value;
      }}}};

constexpr std::array<EffectParameter, 2> kAsymmetricViscous{
    {{"positive_nspm", Domain::kNotNegative, Strength::kTimes,
      [](const SimulationConfig& config) { return 1.5 * viscous_nspm(config); },
      set_truck<&TruckConfig::damping, &DampingEffects::viscous_positive_nspm>},
     {"negative_nspm", Domain::kNotNegative, Strength::kTimes,
      [](const SimulationConfig& config) { return 0.5 * viscous_nspm(config); },
      set_truck<&TruckConfig::damping, &DampingEffects::viscous_negative_nspm>}}};

constexpr std::array<EffectParameter, 1> kQuadraticDamping{
    {{"coefficient_ns2pm2", Domain::kNotNegative, Strength::kTimes,
      [](const SimulationConfig& config) { return viscous_nspm(config) / kTypicalSpeedMps; },
      set_truck<&TruckConfig::damping, &DampingEffects::quadratic_ns2pm2>}}};

constexpr std::array<EffectParameter, 1> kOffsetForce{
    {{"force_n", Domain::kAny, Strength::kTimes,
      [](const SimulationConfig& config) { return 0.1 * coulomb_level_n(config); },
      set_truck<&TruckConfig::damping, &DampingEffects::offset_n>}}};

constexpr std::array<EffectParameter, 1> kCoulomb{
    {{"level_n", Domain::kNotNegative, Strength::kTimes, coulomb_level_n,
      [](SimulationConfig& config, double value) {
        config.truck.friction_positive_n = config.truck.friction_negative_n =
            value / config.truck.friction_scale;
      }}}};

constexpr std::array<EffectParameter, 2> kAsymmetricCoulomb{
    {{"positive_n", Domain::kNotNegative, Strength::kNone,
      [](const SimulationConfig& config) { return 0.7 * coulomb_level_n(config); },
      [](SimulationConfig& config, double value) {
        config.truck.friction_positive_n = value / config.truck.friction_scale;
      }},
     {"negative_n", Domain::kNotNegative, Strength::kNone,
      [](const SimulationConfig& config) { return 1.3 * coulomb_level_n(config); },
      [](SimulationConfig& config, double value) {
        config.truck.friction_negative_n = value / config.truck.friction_scale;
      }}}};

constexpr std::array<EffectParameter, 2> kProgressiveFriction{
    {{"length_m", Domain::kPositive, Strength::kDivide, fixed<4000>,
      set_truck<&TruckConfig::damping, &DampingEffects::progressive_length_m>},
     {"absolute", Domain::kNotNegative, Strength::kNone, fixed<0>,
      [](SimulationConfig& config, double value) {
        config.truck.damping.progressive_absolute = value != 0.0;
      }}}};

constexpr std::array<EffectParameter, 2> kStribeck{
    {{"share", Domain::kAny, Strength::kTimes, fixed<400000>,
      set_truck<&TruckConfig::damping, &DampingEffects::stribeck_share>},
     {"speed_mps", Domain::kPositive, Strength::kNone, fixed<10000>,
      set_truck<&TruckConfig::damping, &DampingEffects::stribeck_speed_mps>}}};

constexpr std::array<EffectParameter, 1> kPreslidingHysteresis{
    {{"distance_m", Domain::kPositive, Strength::kTimes, fixed<150>,
      set_truck<&TruckConfig::hysteresis, &HysteresisEffects::presliding_distance_m>}}};

constexpr std::array<EffectParameter, 2> kViscoelastic{
    {{"stiffness_npm", Domain::kNotNegative, Strength::kTimes,
      [](const SimulationConfig& config) { return 0.4 * config.truck.stiffness_npm; },
      set_truck<&TruckConfig::hysteresis, &HysteresisEffects::viscoelastic_npm>},
     {"time_s", Domain::kPositive, Strength::kNone, fixed<20000>,
      set_truck<&TruckConfig::hysteresis, &HysteresisEffects::viscoelastic_s>}}};

constexpr std::array<EffectParameter, 1> kBacklash{
    {{"gap_m", Domain::kPositive, Strength::kTimes, fixed<300>,
      set_truck<&TruckConfig::hysteresis, &HysteresisEffects::backlash_gap_m>}}};

constexpr std::array<EffectParameter, 3> kBumpStop{
    {{"gap_m", Domain::kNotNegative, Strength::kNone,
      [](const SimulationConfig& config) { return 1.8e-3 * reach(config); },
      set_truck<&TruckConfig::stiffness, &StiffnessEffects::bump_gap_m>},
     {"stiffness_npm", Domain::kPositive, Strength::kTimes,
      [](const SimulationConfig& config) { return 3.0 * config.truck.stiffness_npm; },
      set_truck<&TruckConfig::stiffness, &StiffnessEffects::bump_stiffness_npm>},
     {"one_sided", Domain::kNotNegative, Strength::kNone, fixed<0>,
      [](SimulationConfig& config, double value) {
        config.truck.stiffness.bump_one_sided = value != 0.0;
      }}}};

constexpr std::array<EffectParameter, 1> kCubicStiffness{
    {{"coefficient_npm3", Domain::kAny, Strength::kTimes,
      [](const SimulationConfig& config) {
        return 0.15 * config.truck.stiffness_npm / (typical_m(config) * typical_m(config));
      },
      set_truck<&TruckConfig::stiffness, &StiffnessEffects::cubic_npm3>}}};

constexpr std::array<EffectParameter, 1> kQuadraticStiffness{
    {{"coefficient_npm2", Domain::kAny, Strength::kTimes,
      [](const SimulationConfig& config) {
        return 0.15 * config.truck.stiffness_npm / typical_m(config);
      },
      set_truck<&TruckConfig::stiffness, &StiffnessEffects::quadratic_npm2>}}};

constexpr std::array<EffectParameter, 1> kAsymmetricStiffness{
    {{"added_npm", Domain::kAny, Strength::kTimes,
      [](const SimulationConfig& config) { return 0.3 * config.truck.stiffness_npm; },
      set_truck<&TruckConfig::stiffness, &StiffnessEffects::asymmetry_npm>}}};

constexpr std::array<EffectParameter, 5> kTimeDrift{
    {{"friction_factor", Domain::kPositive, Strength::kAboutOne, fixed<700000>,
      set_truck<&TruckConfig::drift, &DriftEffects::friction_factor>},
     {"stiffness_factor", Domain::kPositive, Strength::kAboutOne, fixed<1000000>,
      set_truck<&TruckConfig::drift, &DriftEffects::stiffness_factor>},
     {"mass_factor", Domain::kPositive, Strength::kAboutOne, fixed<1000000>,
      set_truck<&TruckConfig::drift, &DriftEffects::mass_factor>},
     {"start_s", Domain::kAny, Strength::kNone, fixed<150000000>,
      set_truck<&TruckConfig::drift, &DriftEffects::start_s>},
     {"end_s", Domain::kAny, Strength::kNone, fixed<150000000>,
      set_truck<&TruckConfig::drift, &DriftEffects::end_s>}}};

constexpr std::array<EffectParameter, 5> kUnmodelledMode{
    {{"pitch_inertia_kgm2", Domain::kNotNegative, Strength::kNone, fixed<1500000000>,
      set_truck<&TruckConfig::modes, &ModeEffects::pitch_inertia_kgm2>},
     {"pitch_half_wheelbase_m", Domain::kPositive, Strength::kNone, fixed<900000>,
      set_truck<&TruckConfig::modes, &ModeEffects::pitch_half_wheelbase_m>},
     {"flexible_share", Domain::kNotNegative, Strength::kNone, fixed<0>,
      [](SimulationConfig& config, double value) {
        config.truck.modes.flexible_share = std::min(value, 0.95);
      }},
     {"flexible_frequency_hz", Domain::kPositive, Strength::kNone, fixed<9000000>,
      set_truck<&TruckConfig::modes, &ModeEffects::flexible_frequency_hz>},
     {"flexible_damping_ratio", Domain::kNotNegative, Strength::kNone, fixed<30000>,
      set_truck<&TruckConfig::modes, &ModeEffects::flexible_damping_ratio>}}};

constexpr std::array<EffectParameter, 3> kTimeSkew{
    {{"frame_s", Domain::kAny, Strength::kTimes, fixed<2000>,
      [](SimulationConfig& config, double value) {
        config.sensors.time_skew_s[0] = skew_s(value);
      }},
     {"wheelset1_s", Domain::kAny, Strength::kTimes, fixed<0>,
      [](SimulationConfig& config, double value) {
        config.sensors.time_skew_s[1] = skew_s(value);
      }},
     {"wheelset2_s", Domain::kAny, Strength::kTimes, fixed<0>,
      [](SimulationConfig& config, double value) {
        config.sensors.time_skew_s[2] = skew_s(value);
      }}}};

constexpr std::array<EffectParameter, 3> kGainError{
    {{"frame", Domain::kAny, Strength::kTimes, fixed<0>, set_sensor<&SensorConfig::gain_error, 0>},
     {"wheelset1", Domain::kAny, Strength::kTimes, fixed<50000>,
      set_sensor<&SensorConfig::gain_error, 1>},
     {"wheelset2", Domain::kAny, Strength::kTimes, fixed<0>,
      set_sensor<&SensorConfig::gain_error, 2>}}};

constexpr std::array<EffectParameter, 4> kCrossAxis{
    {{"frame_rad", Domain::kAny, Strength::kTimes, fixed<100000>,
      set_sensor<&SensorConfig::tilt_rad, 0>},
     {"wheelset1_rad", Domain::kAny, Strength::kTimes, fixed<0>,
      set_sensor<&SensorConfig::tilt_rad, 1>},
     {"wheelset2_rad", Domain::kAny, Strength::kTimes, fixed<0>,
      set_sensor<&SensorConfig::tilt_rad, 2>},
     {"lateral_mps2", Domain::kNotNegative, Strength::kNone, fixed<600000>,
      [](SimulationConfig& config, double value) { config.sensors.lateral_mps2 = value; }}}};

constexpr std::array<EffectParameter, 8> kImpulsiveInput{
    {{"shock_force_n", Domain::kNotNegative, Strength::kTimes,
      [](const SimulationConfig& config) { return 3.0 * coulomb_level_n(config); },
      set_impulse<&ImpulseEffects::shock_force_n>},
     {"shock_rate_hz", Domain::kPositive, Strength::kNone, fixed<200000>,
      set_impulse<&ImpulseEffects::shock_rate_hz>},
     {"shock_duration_s", Domain::kPositive, Strength::kNone, fixed<20000>,
      set_impulse<&ImpulseEffects::shock_duration_s>},
     {"joint_depth_m", Domain::kNotNegative, Strength::kNone, fixed<0>,
      set_impulse<&ImpulseEffects::joint_depth_m>},
     {"joint_length_m", Domain::kPositive, Strength::kNone, fixed<300000>,
      set_impulse<&ImpulseEffects::joint_length_m>},
     {"joint_spacing_m", Domain::kPositive, Strength::kNone, fixed<25000000>,
      set_impulse<&ImpulseEffects::joint_spacing_m>},
     {"flat_depth_m", Domain::kNotNegative, Strength::kNone, fixed<0>,
      set_impulse<&ImpulseEffects::flat_depth_m>},
     {"flat_length_m", Domain::kPositive, Strength::kNone, fixed<100000>,
      set_impulse<&ImpulseEffects::flat_length_m>}}};

constexpr std::array<Effect, 21> kEffects{
    {{"viscous", "c v", kViscous},
     {"asymmetric_viscous", "c+ v for v > 0, c- v for v < 0", kAsymmetricViscous},
     {"quadratic_damping", "q v |v|", kQuadraticDamping},
     {"coulomb", "F sign v, alike in both directions", kCoulomb},
     {"asymmetric_coulomb", "F+ for v > 0, F- for v < 0", kAsymmetricCoulomb},
     {"offset_force", "a constant force", kOffsetForce},
     {"progressive_friction",
      "friction times 1 + y / length, never below 0; absolute=1: 1 + |y| / length",
      kProgressiveFriction},
     {"stribeck", "friction times 1 + share exp(-|v| / speed)", kStribeck},
     {"presliding_hysteresis", "friction builds up over a distance after each reversal (Dahl)",
      kPreslidingHysteresis},
     {"viscoelastic", "a spring behind a dashpot beside the suspension; time: dashpot over spring",
      kViscoelastic},
     {"backlash", "no friction until a gap is taken up after each reversal", kBacklash},
     {"bump_stop", "contact beyond a gap; one_sided=1: for y > 0 only", kBumpStop},
     {"cubic_stiffness", "k3 y^3", kCubicStiffness},
     {"quadratic_stiffness", "k2 y^2", kQuadraticStiffness},
     {"asymmetric_stiffness", "more stiffness for y > 0 only", kAsymmetricStiffness},
     {"time_drift",
      "friction, stiffness and mass reach these factors at end, linearly from start; a step "
      "where end <= start",
      kTimeDrift},
     {"unmodelled_mode", "pitch of the frame (inertia 0: none), flexible body (share 0: none)",
      kUnmodelledMode},
     {"time_skew", "channels that show the past (positive) or the future, 20 ms at most",
      kTimeSkew},
     {"gain_error", "relative errors of the sensitivities", kGainError},
     {"cross_axis", "tilted sensors that see a lateral acceleration", kCrossAxis},
     {"impulsive_input",
      "shocks on the frame that no sensor measures; rail joints and a wheel flat, which the "
      "wheelsets measure (depth 0: none)",
      kImpulsiveInput}}};

}  // namespace

std::span<const Effect> effects() noexcept { return kEffects; }

}  // namespace dampline::sim
