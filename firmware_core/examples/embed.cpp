// SPDX-License-Identifier: MIT
// Frames in (a log of candump on standard input), level and stiffness with their deviations out.
#include <cstdio>

#include "dampline/damping/estimator.hpp"
#include "dampline/sample/assembler.hpp"

int main() {
  dampline::AssemblerConfig signals;  // ACCEL_Z 0|12@1- (scale,0), COUNTER 12|12@1+
  for (unsigned c = 0; c < 3; ++c)
    signals.channels[c] = {
        .id = 0x310 + c,
        .accel = {.length = 12, .is_signed = true, .scale = (c == 0 ? 49.03325 : 98.0665) / 2048},
        .has_counter = true,
        .counter = {.start_bit = 12, .length = 12}};
  static dampline::SampleAssembler assembler{signals};
  static dampline::Estimator estimator{dampline::EstimatorConfig{}};
  dampline::CanFrame frame{.length = 4};
  for (long long s, us;
       std::scanf(" (%lld.%lld) %*s %x#%2hhx%2hhx%2hhx%2hhx", &s, &us, &frame.id, &frame.data[0],
                  &frame.data[1], &frame.data[2], &frame.data[3]) == 7;) {
    frame.time_ns = s * 1'000'000'000 + us * 1'000;
    assembler.push(frame);
    for (dampline::Sample sample; assembler.pop(sample);) estimator.update(sample);
  }
  estimator.finish();
  const dampline::Level now = estimator.level();
  std::printf("level %.0f +- %.0f N, stiffness %.0f +- %.0f N/m\n", now.coulomb_n.value,
              now.coulomb_n.std, now.stiffness_npm.value, now.stiffness_npm.std);
}
