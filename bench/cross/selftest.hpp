// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "dampline/identifier.hpp"

namespace dampline::cross {

/// What SELFTEST_IDENTIFIER names: this, SmallIdentifier or EmbeddedIdentifier.
using EstimateIdentifier = BasicIdentifier<kEstimateParts>;
using Tested = SELFTEST_IDENTIFIER;

/// Lies in static storage, as on a target without a heap.
struct SelfTest {
  Tested identifier{IdentifierConfig{}};
  Snapshot snapshot{};
};

inline constexpr std::array<double, kChannels> kCountMps2{49.03325 / 2048.0, 98.0665 / 2048.0,
                                                          98.0665 / 2048.0};

/// The ride, sample by sample, to its snapshot; `begin()` and `end()` stand around each push.
template <std::size_t Samples, class Begin, class End>
void run(SelfTest& test, const std::array<std::array<std::int16_t, kChannels>, Samples>& counts,
         Begin begin, End end) {
  std::int64_t tick = 0;
  for (const auto& instant : counts) {
    Sample sample{.tick = tick, .time_ns = tick * 10'000'000 / 3};
    for (std::size_t c = 0; c < kChannels; ++c) sample.accel_mps2[c] = kCountMps2[c] * instant[c];
    begin();
    test.identifier.push(sample);
    end();
    ++tick;
  }
  test.identifier.finish();
  test.snapshot = test.identifier.snapshot();
}

/// Every figure as the 16 digits of its bits, one a line, through `put(const char*)`.
template <class Put>
void print(const Snapshot& snapshot, Put put) {
  const auto line = [&put](const char* name, double value) {
    std::array<char, 18> digits{};
    auto bits = std::bit_cast<std::uint64_t>(value);
    for (std::size_t i = 16; i-- > 0; bits >>= 4U) digits[i] = "0123456789abcdef"[bits & 15U];
    digits[16] = '\n';
    put(name);
    put(digits.data());
  };
  line("coulomb_n ", snapshot.coulomb_n.value);
  line("coulomb_std_n ", snapshot.coulomb_n.std);
  line("stiffness_npm ", snapshot.stiffness_npm.value);
  line("stiffness_std_npm ", snapshot.stiffness_npm.std);
  line("viscous_nspm ", snapshot.viscous_nspm.value);
  line("held_out_nmse ", snapshot.held_out_nmse);
  line("velocity_rms_mps ", snapshot.velocity_rms_mps);
  for (const CurvePoint& point : snapshot.curve) line("curve_n ", point.force_n);
}

}  // namespace dampline::cross
