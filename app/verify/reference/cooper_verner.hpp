// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

namespace dampline::sim::reference {

/// References are computed in extended precision: second differences of the samples amplify
/// round-off by 1/dt^2, and the reference must not be what limits an estimate.
using Real = long double;

/// sqrt(21).
inline constexpr Real kRoot21 = 4.582575694955840006588047193728008489L;

inline constexpr std::size_t kStages = 11;

/// The explicit Runge-Kutta method of order eight with eleven stages, in closed form: Cooper and
/// Verner, "Some explicit Runge-Kutta methods of high order", SIAM Journal on Numerical Analysis 9
/// (1972). Row i holds the weights of the stages before i.
struct CooperVerner {
  static constexpr Real kS = kRoot21;
  static constexpr std::array<Real, kStages> kNodes{
      0,    0.5L,          0.5L, (7 + kS) / 14, (7 + kS) / 14, 0.5L, (7 - kS) / 14, (7 - kS) / 14,
      0.5L, (7 + kS) / 14, 1};
  static constexpr std::array<std::array<Real, kStages - 1>, kStages> kWeights{{
      {},
      {0.5L},
      {0.25L, 0.25L},
      {1.0L / 7, (-7 - 3 * kS) / 98, (21 + 5 * kS) / 49},
      {(11 + kS) / 84, 0, (18 + 4 * kS) / 63, (21 - kS) / 252},
      {(5 + kS) / 48, 0, (9 + kS) / 36, (-231 + 14 * kS) / 360, (63 - 7 * kS) / 80},
      {(10 - kS) / 42, 0, (-432 + 92 * kS) / 315, (633 - 145 * kS) / 90, (-504 + 115 * kS) / 70,
       (63 - 13 * kS) / 35},
      {1.0L / 14, 0, 0, 0, (14 - 3 * kS) / 126, (13 - 3 * kS) / 63, 1.0L / 9},
      {1.0L / 32, 0, 0, 0, (91 - 21 * kS) / 576, 11.0L / 72, (-385 - 75 * kS) / 1152,
       (63 + 13 * kS) / 128},
      {1.0L / 14, 0, 0, 0, 1.0L / 9, (-733 - 147 * kS) / 2205, (515 + 111 * kS) / 504,
       (-51 - 11 * kS) / 56, (132 + 28 * kS) / 245},
      {0, 0, 0, 0, (-42 + 7 * kS) / 18, (-18 + 28 * kS) / 45, (-273 - 53 * kS) / 72,
       (301 + 53 * kS) / 72, (28 - 28 * kS) / 45, (49 - 7 * kS) / 18},
  }};
  static constexpr std::array<Real, kStages> kSum{
      1.0L / 20, 0, 0, 0, 0, 0, 0, 49.0L / 180, 16.0L / 45, 49.0L / 180, 1.0L / 20};
};

/// The state `step_s` after `state`, where `rate(time_s, state)` returns the state's derivative.
template <std::size_t States, class Rate>
[[nodiscard]] std::array<Real, States> advance(const Rate& rate, Real time_s,
                                               const std::array<Real, States>& state, Real step_s) {
  std::array<std::array<Real, States>, kStages> slope{};
  for (std::size_t i = 0; i < kStages; ++i) {
    std::array<Real, States> at = state;
    for (std::size_t j = 0; j < i; ++j) {
      const Real weight = step_s * CooperVerner::kWeights[i][j];
      if (weight == 0) continue;
      for (std::size_t n = 0; n < States; ++n) at[n] += weight * slope[j][n];
    }
    slope[i] = rate(time_s + CooperVerner::kNodes[i] * step_s, at);
  }
  std::array<Real, States> next = state;
  for (std::size_t i = 0; i < kStages; ++i) {
    const Real weight = step_s * CooperVerner::kSum[i];
    if (weight == 0) continue;
    for (std::size_t n = 0; n < States; ++n) next[n] += weight * slope[i][n];
  }
  return next;
}

}  // namespace dampline::sim::reference
