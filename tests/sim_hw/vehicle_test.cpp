// SPDX-License-Identifier: MIT
#include "sim_hw/vehicle.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

namespace dampline::sim {
namespace {

constexpr double kStepS = 1.0 / 2400.0;
constexpr auto kLead = TruckPosition::kLeading;
constexpr auto kTrail = TruckPosition::kTrailing;

/// Equation 1 written down in other coordinates than Vehicle's: heights of the body's middle and
/// tilts of the three bodies, q = (z, phi, theta_1, theta_2), and heights of four wheelsets.
struct Plane {
  double body_kg, inertia_kgm2, frame_kg, frame_inertia_kgm2, l, a, stiffness_npm;
  Plane(const VehicleConfig& vehicle, const TruckConfig& truck)
      : body_kg(2.0 * (truck.moving_mass_kg - vehicle.frame_mass_kg)),
        inertia_kgm2(body_kg * std::pow(vehicle.gyration_radius_m, 2)),
        frame_kg(vehicle.frame_mass_kg),
        frame_inertia_kgm2(truck.modes.pitch_inertia_kgm2),
        l(vehicle.half_pivot_distance_m),
        a(truck.modes.pitch_half_wheelbase_m),
        stiffness_npm(truck.stiffness_npm) {}
  /// Rows: compression of the suspension over each wheelset, wheelsets at rest.
  [[nodiscard]] Eigen::Matrix4d compression() const {
    Eigen::Matrix4d rows;
    rows << 1, l, a, 0,  //
        1, l, -a, 0,     //
        1, -l, 0, a,     //
        1, -l, 0, -a;
    return rows;
  }
  [[nodiscard]] Eigen::Matrix4d mass() const {
    return Eigen::Vector4d{body_kg + 2.0 * frame_kg, inertia_kgm2 + 2.0 * frame_kg * l * l,
                           frame_inertia_kgm2, frame_inertia_kgm2}
        .asDiagonal();
  }
  /// k y is 2 k_zz (y_1 + y_2): each wheelset carries k times its compression.
  [[nodiscard]] Eigen::Matrix4d stiffness() const {
    return stiffness_npm * compression().transpose() * compression();
  }
  /// What Vehicle counts in, from compressions or their rates.
  [[nodiscard]] static std::array<TruckMotion, 2> motion(const Eigen::Vector4d& compressions,
                                                         const Eigen::Vector4d& rates) {
    const auto one = [&](Eigen::Index i) {
      return TruckMotion{compressions[i] + compressions[i + 1], rates[i] + rates[i + 1],
                         0.5 * (compressions[i] - compressions[i + 1]),
                         0.5 * (rates[i] - rates[i + 1])};
    };
    return {one(0), one(2)};
  }
};

TruckConfig with_frame_pitch(TruckConfig config) {
  config.modes.pitch_inertia_kgm2 = kFramePitchInertiaKgm2;
  return config;
}

VehicleConfig uncoupled() {
  VehicleConfig config;
  config.gyration_radius_m = config.half_pivot_distance_m;
  return config;
}

Excitation shaken(double t, double phase) {
  return {.wheelset_mps2 = {0.8 * std::sin(14.0 * t + phase) + 0.5 * std::sin(31.0 * t + 1.0),
                            0.9 * std::sin(17.0 * t + phase)},
          .force_n = 2000.0 * std::sin(9.0 * t)};
}

/// Largest difference of deflections and frame accelerations between a vehicle's trucks and
/// single trucks, over the largest of them, during 10 s.
double difference_to_trucks(const VehicleConfig& vehicle_config, const TruckConfig& config,
                            double phase) {
  Vehicle vehicle{vehicle_config, config};
  std::array<Truck, 2> trucks{Truck{config}, Truck{config}};
  const auto input = [&](double t) {
    return Vehicle::Excitations{shaken(t, 0.0), shaken(t, phase)};
  };
  double difference = 0.0;
  double largest = 0.0;
  for (int n = 0; n < 24000; ++n) {
    const double t = n * kStepS;
    const auto start = input(t);
    const auto middle = input(t + 0.5 * kStepS);
    const auto end = input(t + kStepS);
    vehicle.step(start, middle, end, kStepS);
    for (const auto position : {kLead, kTrail}) {
      const auto i = static_cast<std::size_t>(position);
      trucks[i].step(start[i], middle[i], end[i], t, kStepS);
      const TruckState& one = trucks[i].state();
      const TruckState& other = vehicle.state(position);
      difference = std::max(difference, std::abs(one.frame_mps2 - other.frame_mps2));
      difference = std::max(difference, std::abs(one.deflection_m - other.deflection_m) * 100.0);
      largest = std::max(largest, std::abs(one.frame_mps2));
    }
  }
  return difference / largest;
}

TEST(Vehicle, WithItsMassAtThePivotsIsTwoTrucks) {
  for (const TruckConfig& config : {laden_truck(), empty_truck()}) {
    EXPECT_LT(difference_to_trucks(uncoupled(), config, 1.3), 1e-9);
    EXPECT_LT(difference_to_trucks(uncoupled(), with_frame_pitch(config), 1.3), 1e-9);
  }
}

TEST(Vehicle, UnderTheSameInputOfBothTrucksIsTwoTrucks) {
  for (const TruckConfig& config : {laden_truck(), with_frame_pitch(empty_truck())})
    EXPECT_LT(difference_to_trucks({}, config, 0.0), 1e-9);
}

TEST(Vehicle, OtherwiseCouplesItsTrucksByTheBody) {
  EXPECT_GT(difference_to_trucks({}, laden_truck(), 1.3), 0.05);
  const VehicleMasses masses = masses_of({}, laden_truck());
  EXPECT_NEAR(masses.own_kg + masses.other_kg, 37200.0, 1e-6);
  // a body of 70 t: 2200 + 70000 (1 + r) / 4 with r = (3.7 / 4.5)^2
  EXPECT_NEAR(masses.own_kg, 2200.0 + 17500.0 * (1.0 + 3.7 * 3.7 / 20.25), 1e-6);
}

TEST(Vehicle, SwingsInItsEigenvectorsAtItsEigenvalues) {
  for (TruckConfig config : {laden_truck(), empty_truck()}) {
    config = with_frame_pitch(config);
    config.friction_scale = 0.0;
    const Plane plane{{}, config};
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix4d> eigen{plane.stiffness(),
                                                                          plane.mass()};
    // bounce of everything is the truck's own frequency
    EXPECT_NEAR(eigen.eigenvalues().head<2>().minCoeff(),
                2.0 * config.stiffness_npm / config.moving_mass_kg, 1e-6);
    for (Eigen::Index mode = 0; mode < 4; ++mode) {
      const double omega = std::sqrt(eigen.eigenvalues()[mode]);
      Eigen::Vector4d shape = plane.compression() * eigen.eigenvectors().col(mode);
      shape *= 1e-3 / shape.norm();
      Vehicle vehicle{{}, config};
      vehicle.set_motion(Plane::motion(shape, Eigen::Vector4d::Zero()));
      for (int n = 1; n <= 9600; ++n) {
        vehicle.step({}, {}, {}, kStepS);
        const Eigen::Vector4d now = shape * std::cos(omega * kStepS * n);
        const auto exact = Plane::motion(now, Eigen::Vector4d::Zero());
        for (const auto position : {kLead, kTrail}) {
          const auto i = static_cast<std::size_t>(position);
          ASSERT_NEAR(vehicle.motion(position).deflection_m, exact[i].deflection_m, 1e-7) << mode;
          ASSERT_NEAR(vehicle.motion(position).pitch_m, exact[i].pitch_m, 1e-7) << mode;
        }
      }
    }
  }
}

TEST(Vehicle, SettlesWhereTheLoadIsCarried) {
  TruckConfig config = with_frame_pitch(laden_truck());
  config.friction_scale = 0.0;
  config.damping.viscous_positive_nspm = config.damping.viscous_negative_nspm = 3e5;
  // 60 kN a quarter of the way from the leading to the trailing pivot
  Vehicle::Excitations load{};
  load[0].force_n = 45e3;
  load[1].force_n = 15e3;
  const auto rest = [&](const TruckConfig& truck) {
    Vehicle vehicle{{}, truck};
    for (int n = 0; n < 24000; ++n) vehicle.step(load, load, load, kStepS);
    EXPECT_LT(std::abs(vehicle.state(kLead).velocity_mps), 1e-4);
    return std::array{vehicle.state(kLead).restoring_force_n,
                      vehicle.state(kTrail).restoring_force_n};
  };
  EXPECT_NEAR(rest(config)[0], 45e3, 1e-3);
  EXPECT_NEAR(rest(config)[1], 15e3, 1e-3);
  // with dry friction, anywhere within its band
  config = with_frame_pitch(laden_truck());
  const auto stuck = rest(config);
  EXPECT_NEAR(stuck[0], 45e3, config.friction_negative_n);
  EXPECT_NEAR(stuck[1], 15e3, config.friction_negative_n);
  EXPECT_GT(std::abs(stuck[0] - 45e3), 100.0);
}

/// Wheelsets that swing in closed form, so that the whole vehicle's heights are known, not only
/// its deflections.
struct Wheelsets {
  static double omega(Eigen::Index i) { return 11.0 + 7.0 * static_cast<double>(i); }
  static constexpr double kAccelMps2 = 0.9;
  static Eigen::Vector4d accel_mps2(double t) {
    return sines(t, [](double) { return kAccelMps2; });
  }
  static Eigen::Vector4d height_m(double t) {
    return sines(t, [](double w) { return -kAccelMps2 / (w * w); });
  }
  static Eigen::Vector4d velocity_mps(double t) {
    Eigen::Vector4d v;
    for (Eigen::Index i = 0; i < 4; ++i) v[i] = -kAccelMps2 / omega(i) * std::cos(omega(i) * t);
    return v;
  }
  template <class Amplitude>
  static Eigen::Vector4d sines(double t, Amplitude amplitude) {
    Eigen::Vector4d x;
    for (Eigen::Index i = 0; i < 4; ++i) x[i] = amplitude(omega(i)) * std::sin(omega(i) * t);
    return x;
  }
  static Vehicle::Excitations excitation(double t) {
    const Eigen::Vector4d x = accel_mps2(t);
    Vehicle::Excitations e{};
    e[0].wheelset_mps2 = {x[0], x[1]};
    e[1].wheelset_mps2 = {x[2], x[3]};
    const Eigen::Vector4d v = velocity_mps(t);
    e[0].wheelset_mps = {v[0], v[1]};
    e[1].wheelset_mps = {v[2], v[3]};
    return e;
  }
};

TEST(Vehicle, BalancesItsEnergy) {
  // kinetic energy of three bodies and potential energy of four springs = work of the wheelsets'
  // forces at their heights - what the four dampers take
  const TruckConfig config = with_frame_pitch(laden_truck());
  const VehicleConfig vehicle_config;
  const Plane plane{vehicle_config, config};
  const Eigen::Matrix4d heights = plane.compression().inverse();
  Vehicle vehicle{vehicle_config, config};
  const double step = 1.0 / 24000.0;
  const Eigen::Vector4d start_rate = -Wheelsets::velocity_mps(0.0);
  vehicle.set_motion(Plane::motion(Eigen::Vector4d::Zero(), start_rate));
  struct Seen {
    double energy_j, input_w, lost_w;
  };
  const auto look = [&](double t) {
    Eigen::Vector4d c;
    Eigen::Vector4d rate;
    for (const auto position : {kLead, kTrail}) {
      const TruckMotion& m = vehicle.motion(position);
      const auto i = 2 * static_cast<Eigen::Index>(position);
      c[i] = 0.5 * m.deflection_m + m.pitch_m;
      c[i + 1] = 0.5 * m.deflection_m - m.pitch_m;
      rate[i] = 0.5 * m.velocity_mps + m.pitch_rate_mps;
      rate[i + 1] = 0.5 * m.velocity_mps - m.pitch_rate_mps;
    }
    const Eigen::Vector4d q_rate = heights * (rate + Wheelsets::velocity_mps(t));
    Seen seen{0.5 * q_rate.dot(plane.mass() * q_rate) + 0.5 * config.stiffness_npm * c.dot(c), 0.0,
              0.0};
    for (Eigen::Index i = 0; i < 4; ++i) {
      const double v = 2.0 * rate[i];
      const double level = v > 0.0 ? config.friction_positive_n : config.friction_negative_n;
      const double friction = 0.5 * level * std::tanh(v / config.law_width_mps);
      seen.lost_w += friction * rate[i];
      seen.input_w -= (friction + config.stiffness_npm * c[i]) * Wheelsets::velocity_mps(t)[i];
    }
    return seen;
  };
  double work = 0.0;
  double lost = 0.0;
  const Seen first = look(0.0);
  Seen before = first;
  for (int n = 0; n < 240000; ++n) {
    const double t = n * step;
    vehicle.step(Wheelsets::excitation(t), Wheelsets::excitation(t + 0.5 * step),
                 Wheelsets::excitation(t + step), step);
    const Seen after = look(t + step);
    work += 0.5 * step * (before.input_w + after.input_w);
    lost += 0.5 * step * (before.lost_w + after.lost_w);
    before = after;
  }
  EXPECT_GT(lost, 100.0);
  EXPECT_NEAR(before.energy_j - first.energy_j, work - lost, 1e-3 * lost);
}

/// Equation 1 as it is printed: heights of both frames and their pitch, q = (z_b1, z_b2, chi_b1,
/// chi_b2), with its letters; k_zz and c_zz of one axle box, of which (2) has two in k and c.
struct Printed {
  Eigen::Matrix4d mass, damping, stiffness;
  Eigen::Matrix4d wheelset_damping, wheelset_stiffness;  // on heights of the wheelsets
  Printed(const VehicleConfig& v, const TruckConfig& truck) {
    const double m_w = v.frame_mass_kg;
    const double m_n = 2.0 * (truck.moving_mass_kg - m_w);
    const double i_n = m_n * v.gyration_radius_m * v.gyration_radius_m;
    const double a_n = v.half_pivot_distance_m;
    const double h = v.centre_height_m;
    const double a = truck.modes.pitch_half_wheelbase_m;
    const double c_x = v.pitch_damping_nms;
    const double i_w = truck.modes.pitch_inertia_kgm2;
    const double turned = (m_n * h * h + i_n) / (4.0 * a_n * a_n);
    mass = Eigen::Vector4d{m_w + 0.25 * m_n + turned, m_w + 0.25 * m_n + turned, i_w, i_w}
               .asDiagonal();
    mass(0, 1) = mass(1, 0) = 0.25 * m_n - turned;
    const auto boxes = [&](double zz) {
      return Eigen::Matrix4d{
          Eigen::Vector4d{4.0 * zz, 4.0 * zz, 4.0 * a * a * zz, 4.0 * a * a * zz}.asDiagonal()};
    };
    const auto wheelsets = [&](double zz) {
      Eigen::Matrix4d out = Eigen::Matrix4d::Zero();
      out.row(0) << -2.0 * zz, -2.0 * zz, 0.0, 0.0;
      out.row(1) << 0.0, 0.0, -2.0 * zz, -2.0 * zz;
      out.row(2) << -2.0 * a * zz, 2.0 * a * zz, 0.0, 0.0;
      out.row(3) << 0.0, 0.0, -2.0 * a * zz, 2.0 * a * zz;
      return out;
    };
    const double c_zz = 0.5 * truck.damping.viscous_positive_nspm;
    const double k_zz = 0.5 * truck.stiffness_npm;
    stiffness = boxes(k_zz);
    wheelset_stiffness = wheelsets(k_zz);
    damping = boxes(c_zz);
    wheelset_damping = wheelsets(c_zz);
    const double twice = c_x / (2.0 * a_n * a_n);
    const double once = c_x / (2.0 * a_n);
    Eigen::Matrix4d between;
    between << twice, -twice, -once, -once,  //
        -twice, twice, once, once,           //
        -once, once, c_x, 0.0,               //
        -once, once, 0.0, c_x;
    damping += between;
  }
  [[nodiscard]] Eigen::Vector4d accel(const Eigen::Vector4d& q, const Eigen::Vector4d& rate,
                                      double t) const {
    return -mass.inverse() *
           (damping * rate + stiffness * q + wheelset_damping * Wheelsets::velocity_mps(t) +
            wheelset_stiffness * Wheelsets::height_m(t));
  }
};

/// Largest difference of deflection and pitch between the vehicle and the printed equations during
/// 4 s, over the largest deflection.
double difference_to_printed(const VehicleConfig& config, const TruckConfig& truck,
                             const VehicleConfig& printed_config) {
  const Printed printed{printed_config, truck};
  const double a = truck.modes.pitch_half_wheelbase_m;
  Vehicle vehicle{config, truck};
  vehicle.set_motion(Plane::motion(Eigen::Vector4d::Zero(), -Wheelsets::velocity_mps(0.0)));
  using State = Eigen::Matrix<double, 8, 1>;
  State x = State::Zero();
  const auto rate = [&](const State& s, double t) {
    State out;
    out << s.tail<4>(), printed.accel(s.head<4>(), s.tail<4>(), t);
    return out;
  };
  double difference = 0.0;
  double largest = 0.0;
  for (int n = 0; n < 9600; ++n) {
    const double t = n * kStepS;
    const double middle = t + 0.5 * kStepS;
    const double end = t + kStepS;
    vehicle.step(Wheelsets::excitation(t), Wheelsets::excitation(middle),
                 Wheelsets::excitation(end), kStepS);
    const State k1 = rate(x, t);
    const State k2 = rate(x + 0.5 * kStepS * k1, middle);
    const State k3 = rate(x + 0.5 * kStepS * k2, middle);
    const State k4 = rate(x + kStepS * k3, end);
    x += kStepS / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    const Eigen::Vector4d z = Wheelsets::height_m(end);
    for (const auto position : {kLead, kTrail}) {
      const auto i = static_cast<Eigen::Index>(position);
      const double y = 2.0 * x[i] - z[2 * i] - z[2 * i + 1];
      const double d = a * x[2 + i] - 0.5 * (z[2 * i] - z[2 * i + 1]);
      const TruckMotion& found = vehicle.motion(position);
      difference = std::max(difference, std::abs(found.deflection_m - y));
      difference = std::max(difference, 2.0 * std::abs(found.pitch_m - d));
      largest = std::max(largest, std::abs(y));
    }
  }
  return difference / largest;
}

TEST(Vehicle, MovesByThePrintedEquations) {
  for (TruckConfig truck : {laden_truck(), empty_truck()}) {
    truck = with_frame_pitch(truck);
    truck.friction_scale = 0.0;
    truck.damping.viscous_positive_nspm = truck.damping.viscous_negative_nspm = 6e4;
    VehicleConfig whole;
    whole.centre_height_m = 1.1;
    whole.pitch_damping_nms = 2.5e4;
    EXPECT_LT(difference_to_printed(whole, truck, whole), 1e-6);
    VehicleConfig low = whole;
    low.centre_height_m = 0.0;
    EXPECT_GT(difference_to_printed(low, truck, whole), 1e-3);
    VehicleConfig loose = whole;
    loose.pitch_damping_nms = 0.0;
    EXPECT_GT(difference_to_printed(loose, truck, whole), 1e-3);
  }
}

TEST(Vehicle, LeavesToTheTruckWhatHasAMemory) {
  EXPECT_TRUE(Vehicle::supports(with_frame_pitch(laden_truck())));
  TruckConfig config = laden_truck();
  config.hysteresis.presliding_distance_m = 1e-4;
  EXPECT_FALSE(Vehicle::supports(config));
  config = laden_truck();
  config.modes.flexible_share = 0.3;
  EXPECT_FALSE(Vehicle::supports(config));
  config = laden_truck();
  config.drift.friction_factor = 0.7;
  EXPECT_FALSE(Vehicle::supports(config));
}

}  // namespace
}  // namespace dampline::sim
