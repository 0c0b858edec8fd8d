// SPDX-License-Identifier: MIT
// Frames in (a log of candump on standard input), level and stiffness with their deviations out.
#include <algorithm>
#include <cstdio>

#include "dampline/identifier.hpp"

int main() {
  dampline::IdentifierConfig config;
  for (unsigned c = 0; c < 3; ++c) {  // ACCEL_Z 0|12@1- (step,0), COUNTER 12|12@1+
    const double step = config.estimator.screen.step_mps2[c] = (c == 0 ? 49.03325 : 98.0665) / 2048;
    config.signals[c] = {.id = 0x310 + c,
                         .accel = {.length = 12, .is_signed = true, .scale = step},
                         .has_counter = true,
                         .counter = {.start_bit = 12, .length = 12}};
  }
  if (!dampline::EmbeddedIdentifier::check(config).ok()) return 1;
  static dampline::EmbeddedIdentifier identifier{config};
  dampline::CanFrame frame{.length = 4};
  unsigned id, byte[4];
  for (long s, us; std::scanf(" (%ld.%ld) %*s %x#%2x%2x%2x%2x", &s, &us, &id, &byte[0], &byte[1],
                              &byte[2], &byte[3]) == 7;) {
    frame.time_ns = s * 1'000'000'000LL + us * 1'000LL;
    frame.id = id;
    std::copy_n(byte, 4, frame.data.begin());
    identifier.push(frame);
  }
  identifier.finish();
  const auto [valid, f, k] = identifier.level();
  std::printf("level %.0f +- %.0f N, stiffness %.0f +- %.0f N/m\n", f.value, f.std, k.value, k.std);
  return valid ? 0 : 1;
}
