// SPDX-License-Identifier: MIT
// The self-test on a bare Cortex-M7: vectors, start-up, output by semihosting, no C library's
// start-up and no heap. At the end it says how much of the stack was ever used, and how many
// instructions a sample took, if qemu was told that one takes a nanosecond (-icount shift=0).
#include <cstdint>
#include <new>

#include "bench/cross/selftest.hpp"

extern "C" {
extern std::uint32_t stack_bottom[];
extern std::uint32_t stack_top[];
extern std::uint32_t data_load[];
extern std::uint32_t data_start[];
extern std::uint32_t data_end[];
extern std::uint32_t bss_start[];
extern std::uint32_t bss_end[];
[[noreturn]] void reset();
[[noreturn]] void fault();
}

namespace {

constexpr std::array<std::array<std::int16_t, 3>, SELFTEST_SAMPLES> kCounts{{
#include "samples.inc"
}};

constexpr std::uint32_t kUnused = 0xA5A5A5A5U;
constexpr std::uint32_t kWrite0 = 0x04;
constexpr std::uint32_t kExit = 0x18;
constexpr std::uint32_t kApplicationExit = 0x20026;
constexpr std::uint32_t kRunTimeError = 0x20023;

void semihost(std::uint32_t operation, std::uintptr_t argument) {
  asm volatile("mov r0, %0\n mov r1, %1\n bkpt 0xab"
               :
               : "r"(operation), "r"(argument)
               : "r0", "r1", "memory");
}
void put(const char* text) { semihost(kWrite0, reinterpret_cast<std::uintptr_t>(text)); }
[[noreturn]] void leave(bool ok) {
  semihost(kExit, ok ? kApplicationExit : kRunTimeError);
  for (;;) continue;
}

void put_number(const char* name, std::uint64_t number) {
  std::array<char, 22> digits{};
  std::size_t at = digits.size() - 2;
  digits[at] = '\n';
  do digits[--at] = static_cast<char>('0' + number % 10);
  while ((number /= 10) > 0);
  put(name);
  put(digits.data() + at);
}

void fill_stack() {
  std::uint32_t here = 0;
  for (std::uint32_t* word = stack_bottom; word < &here - 64; ++word)
    *static_cast<volatile std::uint32_t*>(word) = kUnused;
}
std::uintptr_t used_stack() {
  const std::uint32_t* word = stack_bottom;
  while (*word == kUnused) ++word;
  return reinterpret_cast<std::uintptr_t>(stack_top) - reinterpret_cast<std::uintptr_t>(word);
}

/// The core's 24-bit timer, which counts down once in 40 instructions at the board's 25 MHz.
class Timer {
 public:
  Timer() {
    *word(4) = kMask;
    *word(8) = 0;
    *word(0) = 5;  // the processor's clock, on
  }
  void begin() { start_ = *word(8); }
  void end() {
    const std::uint64_t now = std::uint64_t{kPerTick} * ((start_ - *word(8)) & kMask);
    sum_ += now;
    if (now > most_) most_ = now;
  }
  [[nodiscard]] std::uint64_t sum() const { return sum_; }
  [[nodiscard]] std::uint64_t most() const { return most_; }

 private:
  static constexpr std::uint32_t kMask = 0xFFFFFFU;
  static constexpr std::uint32_t kPerTick = 40;
  static volatile std::uint32_t* word(std::uintptr_t offset) {
    return reinterpret_cast<volatile std::uint32_t*>(0xE000E010U + offset);
  }
  std::uint32_t start_{0};
  std::uint64_t sum_{0};
  std::uint64_t most_{0};
};

alignas(dampline::cross::SelfTest) std::array<std::byte, sizeof(dampline::cross::SelfTest)> storage;

[[gnu::noinline]] bool self_test() {
  auto* test = new (storage.data()) dampline::cross::SelfTest;
  Timer timer;
  dampline::cross::run(
      *test, kCounts, [&timer] { timer.begin(); }, [&timer] { timer.end(); });
  dampline::cross::print(test->snapshot, put);
  put_number("instructions_mean ", timer.sum() / kCounts.size());
  put_number("instructions_most ", timer.most());
  return test->snapshot.valid;
}

}  // namespace

extern "C" [[noreturn]] void reset() {
  auto* const coprocessors = reinterpret_cast<volatile std::uint32_t*>(0xE000ED88U);
  *coprocessors = *coprocessors | 0x00F00000U;  // the floating-point unit
  asm volatile("dsb\n isb" ::: "memory");
  const std::uint32_t* from = data_load;
  for (std::uint32_t* to = data_start; to < data_end; ++to) *to = *from++;
  for (std::uint32_t* to = bss_start; to < bss_end; ++to) *to = 0;
  fill_stack();
  const bool valid = self_test();
  put_number("stack_bytes ", used_stack());
  put_number("identifier_bytes ", sizeof(dampline::cross::Tested));
  leave(valid);
}

extern "C" [[noreturn]] void fault() {
  put("fault\n");
  leave(false);
}

// What the language may refer to and a target without exit needs not do.
extern "C" {
void* __dso_handle = nullptr;
[[noreturn]] void abort() { fault(); }
}

[[gnu::section(".vectors"), gnu::used]] const std::array<std::uintptr_t, 16> vectors{
    reinterpret_cast<std::uintptr_t>(stack_top), reinterpret_cast<std::uintptr_t>(&reset),
    reinterpret_cast<std::uintptr_t>(&fault),    reinterpret_cast<std::uintptr_t>(&fault),
    reinterpret_cast<std::uintptr_t>(&fault),    reinterpret_cast<std::uintptr_t>(&fault),
    reinterpret_cast<std::uintptr_t>(&fault)};
