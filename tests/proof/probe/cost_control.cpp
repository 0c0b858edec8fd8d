// SPDX-License-Identifier: MIT
// Calls of known cost, so that the counting itself can be checked.
#include <cstdint>

extern "C" [[gnu::noinline]] void work_measured(std::uint64_t rounds) {
  volatile std::uint64_t left = rounds;
  while (left > 0) left = left - 1;
}

int main() {
  work_measured(1'000);
  work_measured(2'000);
  work_measured(100'000);
  return 0;
}
