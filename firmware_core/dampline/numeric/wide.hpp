// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>

/// Before a function: compiled a second time for AVX2, where the loader takes that version on a
/// processor that has it. Both versions do the same operations in the same order on each number
/// (-ffp-contract=off, sums in fixed lanes), so that results are the same bits everywhere. Callees
/// are inlined, since only what is inlined is compiled for the wider vectors. Sanitizers run before
/// the loader has chosen, and clang cannot do this to members: there it means nothing.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define DAMPLINE_WIDE [[gnu::target_clones("avx2", "default"), gnu::flatten]]
#else
#define DAMPLINE_WIDE
#endif

namespace dampline {

/// Four numbers that go through one instruction where the processor has one for so many, else
/// through two or four; lane by lane the same bits.
using Wide = double __attribute__((vector_size(32)));
/// Four neighbours in memory, aligned as one of them is.
struct [[gnu::packed, gnu::aligned(alignof(double)), gnu::may_alias]] WideInMemory {
  Wide numbers;
};

inline const WideInMemory& wide(const double* first) noexcept {
  return *reinterpret_cast<const WideInMemory*>(first);
}
inline WideInMemory& wide(double* first) noexcept {
  return *reinterpret_cast<WideInMemory*>(first);
}

/// Sum of a[i] b[i]: number i goes to lane i % 8, then the lanes are added, and the last count % 4
/// numbers to that; the same bits on every machine.
[[nodiscard]] double wide_dot(const double* a, const double* b, std::size_t count) noexcept;

}  // namespace dampline
