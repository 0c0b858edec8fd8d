// SPDX-License-Identifier: MIT
#pragma once
#pragma GCC system_header  // no warnings: what converts here converts where the constant is used

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <type_traits>

/// \file
/// The constants of a tree that tests/vary builds. `VARIED=key=number` sets one of them; where
/// `VARIED_USES` names a file, "key half" or "key double" is appended to it the first time that
/// this value would have made a difference.
namespace varied {

/// Where one constant would have made a difference.
struct Use {
  const char* key;
  std::atomic<unsigned> noted{0};

  void note(bool low, bool high) noexcept {
    const unsigned now = (low ? 1U : 0U) | (high ? 2U : 0U);
    const unsigned fresh = now & ~noted.fetch_or(now);
    const char* const path = std::getenv("VARIED_USES");
    if (fresh == 0 || path == nullptr) return;
    std::FILE* const file = std::fopen(path, "a");
    if (file == nullptr) std::abort();
    if ((fresh & 1U) != 0) std::fprintf(file, "%s half\n", key);
    if ((fresh & 2U) != 0) std::fprintf(file, "%s double\n", key);
    std::fclose(file);
  }
};

/// A number, and what it would be were its constant at either other value. Comparisons note where
/// they would come out otherwise; so does a conversion of numbers that differ, since nothing is
/// known of them behind it.
template <class T>
struct Number {
  T value, low, high;
  Use* use;

  operator T() const noexcept {
    use->note(low != value, high != value);
    return value;
  }
  Number operator-() const noexcept { return {-value, -low, -high, use}; }
};

template <class T>
concept Plain = std::is_arithmetic_v<T>;

/// An operation on all three values of its operands.
template <class F, class A, class B>
auto each(F f, const Number<A>& a, const Number<B>& b) noexcept {
  using Out = Number<decltype(f(a.value, b.value))>;
  if (a.use == b.use) return Out{f(a.value, b.value), f(a.low, b.low), f(a.high, b.high), a.use};
  const auto value = f(A{a}, B{b});  // of two constants: neither is followed further
  return Out{value, value, value, a.use};
}
template <class F, class A, Plain B>
auto each(F f, const Number<A>& a, B b) noexcept {
  return each(f, a, Number<B>{b, b, b, a.use});
}
template <class F, Plain A, class B>
auto each(F f, A a, const Number<B>& b) noexcept {
  return each(f, Number<A>{a, a, a, b.use}, b);
}

#define VARIED_OPERATOR(op, Result)                                                        \
  template <class A, class B>                                                              \
  requires(Plain<B> || requires(B b) { b.use; }) Result operator op(const Number<A>& a,    \
                                                                    const B& b) noexcept { \
    return each([](auto x, auto y) noexcept { return x op y; }, a, b);                     \
  }                                                                                        \
  template <Plain A, class B>                                                              \
  Result operator op(const A& a, const Number<B>& b) noexcept {                            \
    return each([](auto x, auto y) noexcept { return x op y; }, a, b);                     \
  }
VARIED_OPERATOR(+, auto)
VARIED_OPERATOR(-, auto)
VARIED_OPERATOR(*, auto)
VARIED_OPERATOR(/, auto)
VARIED_OPERATOR(<, bool)
VARIED_OPERATOR(<=, bool)
VARIED_OPERATOR(>, bool)
VARIED_OPERATOR(>=, bool)
VARIED_OPERATOR(==, bool)
VARIED_OPERATOR(!=, bool)
#undef VARIED_OPERATOR

/// The constant: as `VARIED` has it, or as it is.
template <class T>
Number<T> constant(const char* key, T value, T low, T high) {
  const char* const text = std::getenv("VARIED");
  const auto length = std::strlen(key);
  auto* const use = new Use{key};
  if (text == nullptr || std::strncmp(text, key, length) != 0 || text[length] != '=')
    return {value, low, high, use};
  const T set = static_cast<T>(std::strtod(text + length + 1, nullptr));
  return {set, set, set, use};
}

}  // namespace varied
