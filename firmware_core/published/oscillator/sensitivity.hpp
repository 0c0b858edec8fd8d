// SPDX-License-Identifier: MIT
#pragma once
#include <type_traits>

#include "published/wavelet/terms.hpp"

namespace dampline {

/// Functions of (x, v), as a list of types.
template <class... Functions>
struct FunctionList {
  static constexpr int kCount = static_cast<int>(sizeof...(Functions));
  /// out[first + i] = the value of function i; `out` is anything with operator[](int).
  template <class Out>
  static void fill([[maybe_unused]] double x, [[maybe_unused]] double v, Out& out,
                   [[maybe_unused]] int first = 0) noexcept {
    ((out[first++] = Functions{}(x, v)), ...);
  }
};

/// sign(x) sign(v).
struct SidedSign {
  [[nodiscard]] double operator()(double x, double v) const noexcept {
    return ExactSign{}(x)*ExactSign{}(v);
  }
};

namespace detail {

template <int M, int N>
struct IfPower {
  using Type = FunctionList<Power<M, N>>;
};
template <int M, int N>
requires(M < 0 || N < 0) struct IfPower<M, N> {
  using Type = FunctionList<>;
};

/// Appends the functions of the second list that are new and not constant.
template <class List, class More>
struct Union {
  using Type = List;
};
template <class... A, class B, class... Rest>
struct Union<FunctionList<A...>, FunctionList<B, Rest...>> {
  static constexpr bool kKnown = std::is_same_v<B, Power<0, 0>> || (std::is_same_v<A, B> || ...);
  using Next = std::conditional_t<kKnown, FunctionList<A...>, FunctionList<A..., B>>;
  using Type = typename Union<Next, FunctionList<Rest...>>::Type;
};

}  // namespace detail

/// What a small slow error of deflection and velocity makes of a term: dg/dx and dg/dv, as a list
/// of functions without common factors (Type). Undefined for terms that no one has derived it for.
/// Derivatives at the kinks themselves are left out; rows do not reach across v = 0.
template <class T>
struct Sensitivity;

template <int M, int N>
struct Sensitivity<Power<M, N>> {
  using Type = typename detail::Union<typename detail::IfPower<M - 1, N>::Type,
                                      typename detail::IfPower<M, N - 1>::Type>::Type;
};
template <>
struct Sensitivity<Friction<ExactSign>> {
  using Type = FunctionList<>;
};
template <>
struct Sensitivity<ProgressiveFriction<ExactSign>> {
  using Type = FunctionList<SidedSign>;
};

namespace detail {

template <class List, class... T>
struct Gather {
  using Type = List;
};
template <class List, class T, class... Rest>
struct Gather<List, T, Rest...> {
  using Next = typename Union<List, typename Sensitivity<T>::Type>::Type;
  using Type = typename Gather<Next, Rest...>::Type;
};

template <class Terms>
struct SensitivitiesOf;
template <class... T>
struct SensitivitiesOf<TermList<T...>> {
  using Type = typename Gather<FunctionList<>, T...>::Type;
};

template <class Wanted, class Terms>
struct PlaceOf;
template <class Wanted, class... T>
struct PlaceOf<Wanted, TermList<T...>> {
  static constexpr int find() noexcept {
    int place = 0;
    int found = -1;
    ((found = found < 0 && std::is_same_v<Wanted, T> ? place : found, ++place), ...);
    return found;
  }
};

}  // namespace detail

/// Of all terms of a TermList: each function once, constants left out.
template <class Terms>
using Sensitivities = typename detail::SensitivitiesOf<Terms>::Type;

/// Place of a term in a TermList, -1 where it is not in it.
template <class Wanted, class Terms>
inline constexpr int kPlaceOf = detail::PlaceOf<Wanted, Terms>::find();

}  // namespace dampline
