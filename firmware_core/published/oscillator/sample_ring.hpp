// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace dampline {

/// The newest accelerations by a number that counts samples: of the mass, and of the mass against
/// its base.
template <int Capacity>
class SampleRing {
 public:
  void set(std::int64_t n, double mass_mps2, double base_mps2) noexcept {
    mass_[at(n)] = mass_mps2;
    relative_[at(n)] = mass_mps2 - base_mps2;
  }
  [[nodiscard]] double mass_mps2(std::int64_t n) const noexcept { return mass_[at(n)]; }
  [[nodiscard]] double relative_mps2(std::int64_t n) const noexcept { return relative_[at(n)]; }

 private:
  static constexpr std::size_t kSize = std::bit_ceil(static_cast<std::size_t>(Capacity));
  [[nodiscard]] static std::size_t at(std::int64_t n) noexcept {
    return static_cast<std::size_t>(n) & (kSize - 1);
  }
  std::array<double, kSize> mass_{};
  std::array<double, kSize> relative_{};
};

}  // namespace dampline
