// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <numbers>

namespace dampline {

// Representations of sign(v), the friction law's regressor. The smooth ones are those of Mostaghel
// and Davis, "Representations of Coulomb friction for dynamic analysis", Earthquake Engineering and
// Structural Dynamics 26 (1997) 541-548; `sharpness_spm` is their alpha, in s/m.

/// The discontinuous one; 0 at rest.
struct ExactSign {
  static constexpr bool kKinkAtRest = true;
  [[nodiscard]] double operator()(double v) const noexcept {
    return v > 0.0 ? 1.0 : (v < 0.0 ? -1.0 : 0.0);
  }
};

/// tanh(alpha v).
struct TanhSign {
  static constexpr bool kKinkAtRest = false;
  double sharpness_spm{1500.0};
  [[nodiscard]] double operator()(double v) const noexcept { return std::tanh(sharpness_spm * v); }
};

/// erf(alpha v).
struct ErfSign {
  static constexpr bool kKinkAtRest = false;
  double sharpness_spm{1500.0};
  [[nodiscard]] double operator()(double v) const noexcept { return std::erf(sharpness_spm * v); }
};

/// 2/pi atan(alpha v).
struct AtanSign {
  static constexpr bool kKinkAtRest = false;
  double sharpness_spm{1500.0};
  [[nodiscard]] double operator()(double v) const noexcept {
    return 2.0 / std::numbers::pi * std::atan(sharpness_spm * v);
  }
};

/// alpha v / (1 + alpha |v|).
struct RationalSign {
  static constexpr bool kKinkAtRest = false;
  double sharpness_spm{1500.0};
  [[nodiscard]] double operator()(double v) const noexcept {
    return sharpness_spm * v / (1.0 + sharpness_spm * std::abs(v));
  }
};

/// v / sqrt(v^2 + eps^2).
struct RootSign {
  static constexpr bool kKinkAtRest = false;
  double width_mps{1e-3};
  [[nodiscard]] double operator()(double v) const noexcept {
    return v / std::sqrt(v * v + width_mps * width_mps);
  }
};

}  // namespace dampline
