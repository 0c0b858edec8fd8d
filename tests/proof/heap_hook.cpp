// SPDX-License-Identifier: MIT
#include "tests/proof/heap_hook.hpp"

#include <cerrno>
#include <cstddef>
#include <cstdlib>

namespace {

thread_local bool armed = false;
thread_local std::uint64_t heap_calls = 0;

void note() noexcept {
  if (armed) ++heap_calls;
}

}  // namespace

// glibc's own entry points, and the public names in their stead.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
extern "C" {
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* block, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);
void __libc_free(void* block);

void* malloc(std::size_t bytes) {
  note();
  return __libc_malloc(bytes);
}
void* calloc(std::size_t count, std::size_t bytes) {
  note();
  return __libc_calloc(count, bytes);
}
void* realloc(void* block, std::size_t bytes) {
  note();
  return __libc_realloc(block, bytes);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) {
  note();
  return __libc_memalign(alignment, bytes);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t bytes) {
  note();
  *block = __libc_memalign(alignment, bytes);
  return *block == nullptr ? ENOMEM : 0;
}
void free(void* block) {
  note();
  __libc_free(block);
}
}
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)

namespace dampline::proof {

HeapWatch::HeapWatch() noexcept {
  heap_calls = 0;
  armed = true;
}

HeapWatch::~HeapWatch() { armed = false; }

std::uint64_t HeapWatch::calls() noexcept { return heap_calls; }

}  // namespace dampline::proof
