// SPDX-License-Identifier: MIT
#pragma once
#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>

namespace dampline::bench {

/// Large objects of one kind beside each other, in pages of 2 MiB where the system gives them, so
/// that a sample of any of them finds its addresses translated; else in ordinary pages.
template <class T>
class LargeArray {
 public:
  /// make(place, i) constructs number i at `place`. Throws std::bad_alloc where there is no memory.
  template <class Make>
  LargeArray(std::size_t count, Make make) : bytes_{count * sizeof(T) + kPage}, count_{count} {
    memory_ = ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory_ == MAP_FAILED) throw std::bad_alloc{};
    static_cast<void>(::madvise(memory_, bytes_, MADV_HUGEPAGE));
    void* first = memory_;
    std::size_t space = bytes_;
    first_ = static_cast<T*>(std::align(kPage, count * sizeof(T), first, space));
    for (std::size_t i = 0; i < count; ++i) make(static_cast<void*>(first_ + i), i);
  }
  ~LargeArray() {
    std::destroy_n(first_, count_);
    ::munmap(memory_, bytes_);
  }
  LargeArray(const LargeArray&) = delete;
  LargeArray& operator=(const LargeArray&) = delete;

  [[nodiscard]] T* begin() noexcept { return first_; }
  [[nodiscard]] T* end() noexcept { return first_ + count_; }
  [[nodiscard]] std::size_t size() const noexcept { return count_; }

 private:
  static constexpr std::size_t kPage = std::size_t{2} << 20U;
  std::size_t bytes_;
  std::size_t count_;
  void* memory_{nullptr};
  T* first_{nullptr};
};

}  // namespace dampline::bench
