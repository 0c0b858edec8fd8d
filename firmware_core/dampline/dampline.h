/* SPDX-License-Identifier: MIT */
/* The identifier for programs in C (C99): plain structs, memory of the caller's, no heap, no errno.
 *
 *   dampline_config config;
 *   dampline_default_config(&config);        then fill in config.channels, or push samples
 *   dampline_identifier *id = dampline_create(memory, size, &config);
 *   dampline_push_frame(id, &frame);         for each frame; other people's are counted and ignored
 *   dampline_snapshot now;
 *   dampline_get_snapshot(id, &now);         at any time; some milliseconds of work
 *
 * What the numbers mean, and when they may be trusted: snapshot.hpp. One identifier is used by one
 * thread at a time; several are independent of each other. Link with libdampline_core and libm. */
#ifndef DAMPLINE_H
#define DAMPLINE_H
/* NOLINTBEGIN: the rules are those of C++. */

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { DAMPLINE_FRAME = 0, DAMPLINE_WHEELSET1 = 1, DAMPLINE_WHEELSET2 = 2, DAMPLINE_CHANNELS = 3 };
enum { DAMPLINE_CURVE_POINTS = 8 };

/* Where a number lies in a frame, in the terms of a DBC file: start_bit|length@order sign
 * (scale,offset) [minimum|maximum]. length 0: there is none. minimum == maximum: not stated. */
typedef struct dampline_signal {
  uint16_t start_bit;
  uint8_t length;
  bool motorola; /* @0 */
  bool is_signed;
  double scale;
  double offset;
  double minimum;
  double maximum;
} dampline_signal;

/* One accelerometer: the frames that carry it. Without a counter samples are numbered by time. */
typedef struct dampline_channel {
  uint32_t id;
  bool extended;           /* 29-bit identifier */
  dampline_signal accel;   /* m/s^2, up is positive */
  dampline_signal counter; /* counts the channel's samples */
  double noise_mps2;       /* white, rms of a sample; 0: unknown */
} dampline_channel;

typedef struct dampline_config {
  dampline_channel channels[DAMPLINE_CHANNELS]; /* truck frame, wheelset 1, wheelset 2 */
  double sample_rate_hz;                        /* 150...400 */
  double moving_mass_kg;                        /* truck frame and its share of the body */
  double anti_alias_corner_hz;                  /* of the sensors' low pass; 0: none, or unknown */
  int32_t anti_alias_order;                     /* 1...8 */
  double wheelbase_m;                           /* 0: unknown */
  double speed_mps;                             /* 0: unknown */
} dampline_config;

typedef struct dampline_frame {
  int64_t time_ns; /* when it was received */
  uint32_t id;
  bool extended;
  uint8_t length; /* bytes, 0...64 */
  uint8_t data[64];
} dampline_frame;

/* Three accelerations of one instant, for those who decode frames themselves. */
typedef struct dampline_sample {
  int64_t tick; /* sample number; a gap is a jump */
  int64_t time_ns;
  double accel_mps2[DAMPLINE_CHANNELS];
  uint8_t saturated; /* bit c: channel c stands at full scale */
} dampline_sample;

/* A number and its standard deviation, in the same unit. */
typedef struct dampline_estimate {
  double value;
  double std;
} dampline_estimate;

typedef struct dampline_snapshot {
  bool valid;   /* false: too little data for what follows */
  int64_t tick; /* newest sample */
  dampline_estimate coulomb_n;
  dampline_estimate stiffness_npm;
  dampline_estimate viscous_nspm; /* of the model that has a viscous part too */
  double held_out_nmse;
  double velocity_rms_mps;
  bool std_is_lower_bound; /* outside the range where deviations were validated */
  uint64_t samples;
  uint64_t samples_lost;
  uint64_t blocks;                                  /* of 2 s, in the estimate */
  double curve_velocity_mps[DAMPLINE_CURVE_POINTS]; /* nodes for v > 0; odd */
  dampline_estimate curve_n[DAMPLINE_CURVE_POINTS];
} dampline_snapshot;

typedef struct dampline_identifier dampline_identifier;

/* Bytes that dampline_create() needs, aligned as a long double is. A constant. */
size_t dampline_size(void);

/* A truck of the freight car that the project simulates, at 300 Hz; channels are left empty. */
void dampline_default_config(dampline_config* config);

/* Places an identifier in memory[0...size - 1], and returns it; it needs no other, and no end: the
 * memory may simply be used for something else. NULL: too little memory, or not aligned, or a
 * setting out of its range. Channels need an accel only where frames are pushed. */
dampline_identifier* dampline_create(void* memory, size_t size, const dampline_config* config);

/* Constant work in the mean, bounded in the worst case. Push one kind or the other, not both. */
void dampline_push_frame(dampline_identifier* self, const dampline_frame* frame);
void dampline_push_sample(dampline_identifier* self, const dampline_sample* sample);

/* The end of a record: what is still held back is taken in. Nothing may be pushed afterwards. */
void dampline_finish(dampline_identifier* self);

void dampline_get_snapshot(dampline_identifier* self, dampline_snapshot* out);

/* How many faults of the data, by kind and channel, were found so far. */
uint32_t dampline_fault_count(const dampline_identifier* self);

typedef struct dampline_fault {
  const char* name;    /* "spikes", "stuck_channel", ... */
  const char* channel; /* "frame", "wheelset1", "wheelset2", "wheelsets" or "all" */
  const char* unit;    /* of size */
  double size;
  double first_s; /* where it was first and last seen */
  double last_s;
} dampline_fault;

/* Fault 0 <= index < dampline_fault_count(), in the order in which they were found; false: none. */
bool dampline_get_fault(const dampline_identifier* self, uint32_t index, dampline_fault* out);

#ifdef __cplusplus
}
#endif
/* NOLINTEND */
#endif
