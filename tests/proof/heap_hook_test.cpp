// SPDX-License-Identifier: MIT
#include "tests/proof/heap_hook.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <new>
#include <string>
#include <thread>

namespace dampline::proof {
namespace {

template <class Action>
std::uint64_t heap_calls_of(const Action& action) {
  const HeapWatch watch;
  action();
  return HeapWatch::calls();
}

/// Keeps the compiler from leaving an allocation out.
void* seen(void* block) noexcept {
  static void* volatile sink = nullptr;
  sink = block;
  return sink;
}

TEST(HeapHook, CountsEveryWayToTheHeap) {
  void* block = nullptr;
  EXPECT_EQ(heap_calls_of([&] { block = seen(std::malloc(8)); }), 1U);
  EXPECT_EQ(heap_calls_of([&] { block = seen(std::realloc(block, 4096)); }), 1U);
  EXPECT_EQ(heap_calls_of([&] { std::free(block); }), 1U);
  EXPECT_EQ(heap_calls_of([] { std::free(seen(std::calloc(3, 8))); }), 2U);
  EXPECT_EQ(heap_calls_of([] { std::free(seen(std::aligned_alloc(64, 128))); }), 2U);
  EXPECT_EQ(heap_calls_of([] { ::operator delete(seen(::operator new(8))); }), 2U);
  struct alignas(64) Line {
    char bytes[64];
  };
  EXPECT_EQ(heap_calls_of([] {
              const std::unique_ptr<Line> line{new Line};
              seen(line.get());
            }),
            2U);
}

TEST(HeapHook, CountsWhatTheLibraryAllocates) {
  const std::string text(100, 'x');
  EXPECT_EQ(heap_calls_of([&] { seen(std::string{text}.data()); }), 2U);
}

TEST(HeapHook, CountsNothingOutsideAWatch) {
  { const HeapWatch watch; }
  std::free(seen(std::malloc(8)));
  EXPECT_EQ(HeapWatch::calls(), 0U);
}

TEST(HeapHook, CountsItsOwnThreadOnly) {
  std::thread other;
  bool ready = false;
  other = std::thread{[&] {
    std::free(seen(std::malloc(8)));
    ready = true;
  }};
  const HeapWatch watch;
  other.join();
  EXPECT_TRUE(ready);
  EXPECT_EQ(HeapWatch::calls(), 0U);
}

}  // namespace
}  // namespace dampline::proof
