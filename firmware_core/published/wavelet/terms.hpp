// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <concepts>
#include <cstddef>
#include <numbers>
#include <utility>

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

/// A regressor g(x, v) of the restoring force sum theta_i g_i(x, v). Where g or a derivative jumps
/// at v = 0 (`kKinkAtRest`) or at x = 0 (`kKinkAtCentre`), the motion is not smooth there, and rows
/// whose stencil reaches across are left out.
template <class T>
concept Term = requires(const T& term, double x, double v) {
  { term(x, v) } -> std::convertible_to<double>;
  { T::kKinkAtRest } -> std::convertible_to<bool>;
  { T::kKinkAtCentre } -> std::convertible_to<bool>;
};

namespace detail {
template <int Exponent>
constexpr double power(double base) noexcept {
  static_assert(Exponent >= 0);
  double out = 1.0;
  for (int i = 0; i < Exponent; ++i) out *= base;
  return out;
}
}  // namespace detail

/// x^M v^N.
template <int M, int N>
struct Power {
  static constexpr bool kKinkAtRest = false;
  static constexpr bool kKinkAtCentre = false;
  [[nodiscard]] constexpr double operator()(double x, double v) const noexcept {
    return detail::power<M>(x) * detail::power<N>(v);
  }
};
using Viscous = Power<0, 1>;
using Spring = Power<1, 0>;
using CubicSpring = Power<3, 0>;      ///< Duffing
using VanDerPolDamper = Power<2, 1>;  ///< x^2 v

/// sign(v): Coulomb friction.
template <class Sign = ExactSign>
struct Friction {
  static constexpr bool kKinkAtRest = Sign::kKinkAtRest;
  static constexpr bool kKinkAtCentre = false;
  Sign sign{};
  [[nodiscard]] double operator()(double /*x*/, double v) const noexcept { return sign(v); }
};

/// |x| sign(v): friction that grows with the deflection (linear/Coulomb).
template <class Sign = ExactSign>
struct ProgressiveFriction {
  static constexpr bool kKinkAtRest = Sign::kKinkAtRest;
  static constexpr bool kKinkAtCentre = true;
  Sign sign{};
  [[nodiscard]] double operator()(double x, double v) const noexcept {
    return std::abs(x) * sign(v);
  }
};

/// exp(-a |v|) sign(v): the part of the friction of Teflon on steel that changes with speed
/// (Mokha, Constantinou and Reinhorn 1990). `rate_spm` is a, in s/m.
template <class Sign = ExactSign>
struct ExponentialFriction {
  static constexpr bool kKinkAtRest = Sign::kKinkAtRest;
  static constexpr bool kKinkAtCentre = false;
  double rate_spm{0.0};
  Sign sign{};
  [[nodiscard]] double operator()(double /*x*/, double v) const noexcept {
    return std::exp(-rate_spm * std::abs(v)) * sign(v);
  }
};

/// Any g(x, v), through one function. `context` is passed on and not owned. `KinkAtRest` and
/// `KinkAtCentre` say where g is not smooth.
template <bool KinkAtRest = false, bool KinkAtCentre = false>
struct UserTerm {
  static constexpr bool kKinkAtRest = KinkAtRest;
  static constexpr bool kKinkAtCentre = KinkAtCentre;
  using Function = double (*)(double x, double v, const void* context) noexcept;
  Function function{nullptr};
  const void* context{nullptr};
  [[nodiscard]] double operator()(double x, double v) const noexcept {
    return function == nullptr ? 0.0 : function(x, v, context);
  }
};

namespace detail {
template <std::size_t I, class T>
struct IndexedTerm {
  T term{};
};
/// As std::tuple, but trivially copyable.
template <class Indices, class... Terms>
struct TermStore;
template <std::size_t... I, class... Terms>
struct TermStore<std::index_sequence<I...>, Terms...> : IndexedTerm<I, Terms>... {};

template <std::size_t I, class T>
constexpr const T& term_at(const IndexedTerm<I, T>& store) noexcept {
  return store.term;
}
}  // namespace detail

/// The terms of one element, fixed at compile time: TermList<Viscous, Spring, Friction<>>{}.
template <Term... Terms>
class TermList {
  using Indices = std::index_sequence_for<Terms...>;

 public:
  static constexpr int kCount = static_cast<int>(sizeof...(Terms));
  static constexpr bool kKinkAtRest = (Terms::kKinkAtRest || ...);
  static constexpr bool kKinkAtCentre = (Terms::kKinkAtCentre || ...);
  static_assert(kCount > 0);

  constexpr TermList() noexcept = default;
  constexpr explicit TermList(const Terms&... terms) noexcept : terms_{{terms}...} {}

  /// out[first...first + kCount - 1] = sign * g_i(x, v); `out` is anything with operator[].
  template <class Out>
  constexpr void fill(double x, double v, double sign, Out& out, int first = 0) const noexcept {
    fill_each(x, v, sign, out, first, Indices{});
  }

  /// The term in place I.
  template <std::size_t I>
  [[nodiscard]] constexpr const auto& term() const noexcept {
    return detail::term_at<I>(terms_);
  }

 private:
  template <class Out, std::size_t... I>
  constexpr void fill_each(double x, double v, double sign, Out& out, int first,
                           std::index_sequence<I...> /*unused*/) const noexcept {
    ((out[first + static_cast<int>(I)] = sign * term<I>()(x, v)), ...);
  }
  detail::TermStore<Indices, Terms...> terms_{};
};

}  // namespace dampline
