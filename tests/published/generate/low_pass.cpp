// SPDX-License-Identifier: MIT
#include "tests/published/generate/low_pass.hpp"

#include <cstddef>
#include <utility>

namespace dampline::generate {
namespace {

struct Complex {
  mpf_class re{0, kBits};
  mpf_class im{0, kBits};
};

Complex make(const mpf_class& re, const mpf_class& im) {
  Complex out;
  out.re = re;
  out.im = im;
  return out;
}
Complex operator+(const Complex& a, const Complex& b) { return make(a.re + b.re, a.im + b.im); }
Complex operator-(const Complex& a, const Complex& b) { return make(a.re - b.re, a.im - b.im); }
Complex operator*(const Complex& a, const Complex& b) {
  return make(a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re);
}
mpf_class square_norm(const Complex& a) { return a.re * a.re + a.im * a.im; }
Complex operator/(const Complex& a, const Complex& b) {
  const mpf_class d = square_norm(b);
  return make((a.re * b.re + a.im * b.im) / d, (a.im * b.re - a.re * b.im) / d);
}

Complex square_root(const Complex& a) {
  const mpf_class size{sqrt(square_norm(a)), kBits};
  const mpf_class larger{sqrt(mpf_class{(size + abs(a.re)) / 2, kBits}), kBits};
  const mpf_class smaller{a.im / (2 * larger), kBits};
  return a.re < 0 ? make(smaller, larger) : make(larger, smaller);
}

/// Zeros of sum_k c_k y^k, by the simultaneous iteration of Durand and Kerner.
std::vector<Complex> zeros(const std::vector<mpz_class>& c) {
  constexpr int kIterations = 400;
  const std::size_t degree = c.size() - 1;
  std::vector<Complex> z(degree);
  const Complex start = make(mpf_class{"0.4", kBits}, mpf_class{"0.9", kBits});
  Complex power = start;
  for (Complex& x : z) {
    x = power;
    power = power * start;
  }
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    for (std::size_t i = 0; i < degree; ++i) {
      Complex value = make(mpf_class{c[degree], kBits}, mpf_class{0, kBits});
      Complex others = value;
      for (std::size_t k = degree; k-- > 0;) {
        value = value * z[i] + make(mpf_class{c[k], kBits}, mpf_class{0, kBits});
      }
      for (std::size_t j = 0; j < degree; ++j) {
        if (j != i) others = others * (z[i] - z[j]);
      }
      z[i] = z[i] - value / others;
    }
  }
  return z;
}

/// polynomial * (y - root) with increasing powers.
std::vector<Complex> times_factor(const std::vector<Complex>& polynomial, const Complex& root) {
  std::vector<Complex> out(polynomial.size() + 1);
  for (std::size_t i = 0; i < polynomial.size(); ++i) {
    out[i + 1] = out[i + 1] + polynomial[i];
    out[i] = out[i] - polynomial[i] * root;
  }
  return out;
}

/// P(y) = sum_(k < N) C(N - 1 + k, k) y^k, Daubechies' equation 6.1.12.
std::vector<mpz_class> daubechies_polynomial(int n) {
  std::vector<mpz_class> c(static_cast<std::size_t>(n));
  for (int k = 0; k < n; ++k) {
    mpz_bin_uiui(c[static_cast<std::size_t>(k)].get_mpz_t(), static_cast<unsigned long>(n - 1 + k),
                 static_cast<unsigned long>(k));
  }
  return c;
}

/// The zero inside the unit circle of z + 1/z = 2 - 4 y.
Complex inner_zero(const Complex& y) {
  const Complex half = make(1 - 2 * y.re, -2 * y.im);
  const Complex root = square_root(half * half - make(mpf_class{1}, mpf_class{0}));
  const Complex z = half + root;
  return square_norm(z) < 1 ? z : half - root;
}

}  // namespace

std::vector<mpf_class> low_pass(int vanishing_moments) {
  std::vector<Complex> h{make(mpf_class{1, kBits}, mpf_class{0, kBits})};
  const Complex minus_one = make(mpf_class{-1, kBits}, mpf_class{0, kBits});
  for (int i = 0; i < vanishing_moments; ++i) h = times_factor(h, minus_one);
  for (const Complex& y : zeros(daubechies_polynomial(vanishing_moments))) {
    h = times_factor(h, inner_zero(y));
  }
  mpf_class sum{0, kBits};
  for (const Complex& x : h) sum += x.re;
  const mpf_class scale{sqrt(mpf_class{2, kBits}) / sum, kBits};
  std::vector<mpf_class> out;
  for (std::size_t i = h.size(); i-- > 0;) out.emplace_back(h[i].re * scale, kBits);
  return out;
}

}  // namespace dampline::generate
