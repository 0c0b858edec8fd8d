// SPDX-License-Identifier: MIT
// Frames in (a log of candump on standard input), level and stiffness with their deviations out.
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
  for (long long s, us;
       std::scanf(" (%lld.%lld) %*s %x#%2hhx%2hhx%2hhx%2hhx", &s, &us, &frame.id, &frame.data[0],
                  &frame.data[1], &frame.data[2], &frame.data[3]) == 7;) {
    frame.time_ns = s * 1'000'000'000 + us * 1'000;
    identifier.push(frame);
  }
  identifier.finish();
  const auto [valid, f, k] = identifier.level();
  std::printf("level %.0f +- %.0f N, stiffness %.0f +- %.0f N/m\n", f.value, f.std, k.value, k.std);
  return valid ? 0 : 1;
}
