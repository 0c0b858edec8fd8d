// SPDX-License-Identifier: MIT
#include "dampline/numeric/fourier.hpp"

#include <algorithm>
#include <numbers>

namespace dampline {
namespace {

struct Phasor {
  double re, im;
};

/// cos and sin by their series, to the last digits for |x| <= pi / 4.
constexpr Phasor near_zero(double x) {
  double cosine = 1.0;
  double sine = x;
  double term_c = 1.0;
  double term_s = x;
  for (int i = 1; i < 12; ++i) {
    term_c *= -x * x / ((2.0 * i - 1.0) * (2.0 * i));
    term_s *= -x * x / ((2.0 * i) * (2.0 * i + 1.0));
    cosine += term_c;
    sine += term_s;
  }
  return {cosine, sine};
}

constexpr std::array<Phasor, Fourier512::kSize / 2> make_phasors() {
  std::array<Phasor, Fourier512::kSize / 2> phasors{};
  constexpr std::size_t kQuarter = Fourier512::kSize / 4;
  constexpr double kAngleRad = 2.0 * std::numbers::pi / static_cast<double>(Fourier512::kSize);
  for (std::size_t k = 0; k < phasors.size(); ++k) {
    const std::size_t in_quarter = k % kQuarter;
    const bool upper = in_quarter > kQuarter / 2;
    const Phasor t =
        near_zero(kAngleRad * static_cast<double>(upper ? kQuarter - in_quarter : in_quarter));
    const Phasor first = upper ? Phasor{t.im, t.re} : t;  // cos, sin within the first quarter
    phasors[k] = k < kQuarter ? Phasor{first.re, -first.im} : Phasor{-first.im, -first.re};
  }
  return phasors;
}

constexpr auto kPhasors = make_phasors();

}  // namespace

Fourier512::Complex Fourier512::turn(std::size_t k) noexcept {
  return {kPhasors[k].re, kPhasors[k].im};
}

bool Fourier512::advance(std::size_t butterflies) noexcept {
  const std::size_t end = std::min(done_ + butterflies, kButterflies);
  for (; done_ < end; ++done_) {
    const std::size_t stage = done_ / (kSize / 2);
    const std::size_t index = done_ % (kSize / 2);
    const std::size_t half = std::size_t{1} << stage;
    const std::size_t within = index & (half - 1);
    const std::size_t low = ((index >> stage) << (stage + 1)) + within;
    const Phasor& w = kPhasors[within << (kStages - 1 - stage)];
    Complex& a = x_[low];
    Complex& b = x_[low + half];
    const double re = b.real() * w.re - b.imag() * w.im;
    const double im = b.real() * w.im + b.imag() * w.re;
    b = {a.real() - re, a.imag() - im};
    a = {a.real() + re, a.imag() + im};
  }
  return done_ == kButterflies;
}

}  // namespace dampline
