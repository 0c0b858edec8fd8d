// SPDX-License-Identifier: MIT
// Does everything that the core must not do, so that the checks of the core can be seen to work.
#include "tests/proof/control/offender.hpp"

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <stdexcept>

namespace dampline::proof {
namespace {

int ask_the_clock() {
  std::timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<int>(now.tv_sec & 1);
}

}  // namespace

void* offend(std::size_t bytes) {
  static const int kStart = ask_the_clock();
  if (bytes == 0) throw std::invalid_argument{"nothing to allocate"};
  std::puts("allocating");
  return kStart == 0 ? std::malloc(bytes) : ::operator new(bytes);
}

}  // namespace dampline::proof
