// SPDX-License-Identifier: MIT
// Vectors of a Cortex-M7 before its C library's own start-up.
#include <array>
#include <cstdint>

extern "C" {
extern std::uint32_t __stack[];
[[noreturn]] void _mainCRTStartup();
[[noreturn]] void reset() {
  auto* const coprocessors = reinterpret_cast<volatile std::uint32_t*>(0xE000ED88U);
  *coprocessors = *coprocessors | 0x00F00000U;  // the floating-point unit
  asm volatile("dsb\n isb" ::: "memory");
  _mainCRTStartup();
}
}

[[gnu::section(".vectors"), gnu::used]] const std::array<std::uintptr_t, 16> vectors{
    reinterpret_cast<std::uintptr_t>(__stack), reinterpret_cast<std::uintptr_t>(&reset)};
