// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <vector>

#include "app/verify/reference/cooper_verner.hpp"

namespace dampline::sim::reference {

/// How sign(v) is represented: exactly, or by one of the four of Mostaghel and Davis,
/// "Representations of Coulomb friction for dynamic analysis", Earthquake Engineering and
/// Structural Dynamics 26 (1997) 541-548.
enum class Signum : std::uint8_t { kExact, kTanh, kErf, kArctangent, kRational };

/// sign(v) with 0 at 0, tanh(s v), erf(s v), (2/pi) atan(s v) or s v / (1 + s |v|), where s is
/// `sharpness_spm` (s/m).
[[nodiscard]] Real signum(Signum kind, Real sharpness_spm, Real v_mps) noexcept;

/// A spring with damping and friction between two masses, or a mass and the ground. With z and v,
/// its stretch and the rate of it, the force is
///   k z + k2 z^2 + k3 z^3 + c v + c2 v^2 + c3 v^3 + d z v + w z^2 v
///     + (e + fk |z| + t exp(-a |v|)) sign v
/// Table 16 calls t "d"; Van der Pol's "c(3)" is w.
struct Element {
  Real k{0}, k2{0}, k3{0};
  Real c{0}, c2{0}, c3{0};
  Real d{0}, w{0};
  Real e{0}, fk{0};
  Real t{0}, a_spm{0};
  Signum signum{Signum::kExact};
  Real sharpness_spm{1500};

  [[nodiscard]] bool has_friction() const noexcept { return e != 0 || fk != 0 || t != 0; }
  /// True where the friction's slope jumps at v = 0, so that a step must end there.
  [[nodiscard]] bool has_kink() const noexcept {
    return has_friction() && (t != 0 || signum == Signum::kExact || signum == Signum::kRational);
  }
  /// True where friction can hold: sign v is exact.
  [[nodiscard]] bool can_stick() const noexcept {
    return has_friction() && signum == Signum::kExact;
  }
};

/// On which branch of its kinks an element is: the sign of v (0 while it sticks) and of z.
struct Branch {
  int of_rate{1};
  int of_stretch{1};
};

/// The force without friction's part.
[[nodiscard]] Real smooth_force(const Element& element, Real z, Real v) noexcept;

/// Friction's largest value at rest, on the branch.
[[nodiscard]] Real hold_force(const Element& element, Branch branch, Real z) noexcept;

/// Friction on the branch. An element that sticks has none here.
[[nodiscard]] Real friction_force(const Element& element, Branch branch, Real z, Real v) noexcept;

/// One force of an input: amplitude_n sin(phase(t)) with phase' = rate_radps + slope_radps2 t, that
/// is, a sine where the slope is 0 and a linear sweep elsewhere.
struct Sine {
  Real amplitude_n{0};
  Real rate_radps{0};
  Real slope_radps2{0};
};

/// The input of one degree of freedom: a sum of sines.
using Input = std::vector<Sine>;

/// Force of the input at a time, N.
[[nodiscard]] Real force_n(const Input& input, Real time_s) noexcept;

}  // namespace dampline::sim::reference
