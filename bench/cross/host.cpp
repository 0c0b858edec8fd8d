// SPDX-License-Identifier: MIT
// The self-test on a system with an operating system.
#include <cstdio>
#include <memory>

#include "bench/cross/selftest.hpp"

namespace {
constexpr std::array<std::array<std::int16_t, 3>, SELFTEST_SAMPLES> kCounts{{
#include "samples.inc"
}};
}  // namespace

int main() {
  const auto test = std::make_unique<dampline::cross::SelfTest>();
  const auto nothing = [] {};
  dampline::cross::run(*test, kCounts, nothing, nothing);
  dampline::cross::print(test->snapshot, [](const char* text) { std::fputs(text, stdout); });
  return test->snapshot.valid ? 0 : 1;
}
