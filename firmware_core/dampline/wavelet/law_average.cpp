// SPDX-License-Identifier: MIT
#include "dampline/wavelet/law_average.hpp"

#include <array>
#include <cstddef>

#include "dampline/wide.hpp"

namespace dampline {
namespace {

constexpr auto kLanes = static_cast<std::size_t>(LawColumns::kLanes);
using Points = std::array<std::array<float, kLanes>, 4>;

}  // namespace

DAMPLINE_WIDE LawAverage::Lanes LawAverage::update(const LawColumns& law, double velocity_mps,
                                                   double accel_mps2, double step_s) noexcept {
  const double m0 = step_s * last_accel_mps2_;
  const double m1 = step_s * accel_mps2;
  const double v0 = last_velocity_mps_;
  const double v1 = velocity_mps;
  Points p;
  law.lanes_to(p[0].data(), v0);
  // Hermite weights at u = 1/4, 1/2, 3/4: (h00, h10, h01, h11) of u.
  law.lanes_to(p[1].data(), (54.0 * v0 + 9.0 * m0 + 10.0 * v1 - 3.0 * m1) / 64.0);
  law.lanes_to(p[2].data(), (4.0 * (v0 + v1) + m0 - m1) / 8.0);
  law.lanes_to(p[3].data(), (10.0 * v0 + 3.0 * m0 + 54.0 * v1 - 9.0 * m1) / 64.0);
  Lanes average;
  float* __restrict out = average.data();
  float* __restrict from_left = from_left_.data();
  for (std::size_t i = 0; i < kLanes; ++i) {
    out[i] =
        from_left[i] + 0.25F * p[0][i] + 0.1875F * p[1][i] + 0.125F * p[2][i] + 0.0625F * p[3][i];
    from_left[i] = 0.0625F * p[1][i] + 0.125F * p[2][i] + 0.1875F * p[3][i];
  }
  last_velocity_mps_ = velocity_mps;
  last_accel_mps2_ = accel_mps2;
  ++count_;
  return average;
}

}  // namespace dampline
