/* SPDX-License-Identifier: MIT */
/* The same in C: frames in (a log of candump on standard input), level and stiffness with their
 * deviations out. */
#include <stdio.h>

#include "dampline/dampline.h"

static union {
  long double aligned;
  unsigned char bytes[1600000]; /* at least dampline_size() */
} memory;
static const double range_mps2[DAMPLINE_CHANNELS] = {49.03325, 98.0665, 98.0665};

int main(void) {
  dampline_config config;
  dampline_default_config(&config);
  for (unsigned c = 0; c < DAMPLINE_CHANNELS; ++c) {
    dampline_channel* channel = &config.channels[c];
    channel->id = 0x310 + c;
    channel->accel =
        (dampline_signal){.length = 12, .is_signed = true, .scale = range_mps2[c] / 2048};
    channel->counter = (dampline_signal){.start_bit = 12, .length = 12, .scale = 1};
  }
  dampline_identifier* identifier = dampline_create(&memory, sizeof memory, &config);
  if (identifier == NULL) {
    fprintf(stderr, "%lu bytes are needed\n", (unsigned long)dampline_size());
    return 1;
  }
  dampline_frame frame = {.length = 4};
  long s, us;
  unsigned id, byte[4];
  while (scanf(" (%ld.%ld) %*s %x#%2x%2x%2x%2x", &s, &us, &id, &byte[0], &byte[1], &byte[2],
               &byte[3]) == 7) {
    frame.time_ns = s * 1000000000LL + us * 1000LL;
    frame.id = id;
    for (int i = 0; i < 4; ++i) frame.data[i] = (uint8_t)byte[i];
    dampline_push_frame(identifier, &frame);
  }
  dampline_finish(identifier);
  dampline_snapshot now;
  dampline_get_snapshot(identifier, &now);
  printf("level %.0f +- %.0f N, stiffness %.0f +- %.0f N/m, %u faults\n", now.coulomb_n.value,
         now.coulomb_n.std, now.stiffness_npm.value, now.stiffness_npm.std,
         (unsigned)dampline_fault_count(identifier));
  return now.valid ? 0 : 1;
}
