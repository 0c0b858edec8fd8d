// SPDX-License-Identifier: MIT
// libgpiod 2 in front of the model. Settings are the library's own; what would reach the kernel,
// and the buffer that only the kernel's answers fill, are the model's.
#include <gpiod.h>

#include <algorithm>
#include <cerrno>
#include <string_view>
#include <vector>

#include "tests/fault/gpiod_model.hpp"

using dampline::fault::GpioModel;
using dampline::fault::ModelEdge;

struct gpiod_chip {};
struct gpiod_line_request {
  std::vector<unsigned> offsets;
};
struct gpiod_edge_event {
  ModelEdge edge;
};
struct gpiod_edge_event_buffer {
  std::vector<gpiod_edge_event> events;
  std::size_t capacity;
};

namespace {

bool may_go_on() { return GpioModel::current() == nullptr || GpioModel::current()->may_go_on(); }

template <class T>
T* made(T* object) {
  if (object != nullptr && GpioModel::current() != nullptr) GpioModel::current()->made(1);
  return object;
}

void given_back(const void* object) {
  if (object != nullptr && GpioModel::current() != nullptr) GpioModel::current()->made(-1);
}

bool request_line(gpiod_line_config* lines, unsigned offset) {
  gpiod_line_settings* const settings = gpiod_line_config_get_line_settings(lines, offset);
  const gpiod_line_edge edge = gpiod_line_settings_get_edge_detection(settings);
  const bool both = edge == GPIOD_LINE_EDGE_BOTH;
  const GpioModel::Wish wish{.offset = offset,
                             .rising = both || edge == GPIOD_LINE_EDGE_RISING,
                             .falling = both || edge == GPIOD_LINE_EDGE_FALLING,
                             .active_low = gpiod_line_settings_get_active_low(settings)};
  made(settings);
  gpiod_line_settings_free(settings);
  return GpioModel::current()->request(wish);
}

}  // namespace

// The linker's own names.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
extern "C" {
gpiod_chip* __real_gpiod_chip_open(const char* path);
gpiod_line_settings* __real_gpiod_line_settings_new();
void __real_gpiod_line_settings_free(gpiod_line_settings* settings);
int __real_gpiod_line_settings_set_direction(gpiod_line_settings* settings,
                                             gpiod_line_direction direction);
int __real_gpiod_line_settings_set_edge_detection(gpiod_line_settings* settings,
                                                  gpiod_line_edge edge);
int __real_gpiod_line_settings_set_event_clock(gpiod_line_settings* settings,
                                               gpiod_line_clock clock);
int __real_gpiod_line_settings_set_output_value(gpiod_line_settings* settings,
                                                gpiod_line_value value);
gpiod_line_config* __real_gpiod_line_config_new();
void __real_gpiod_line_config_free(gpiod_line_config* lines);
int __real_gpiod_line_config_add_line_settings(gpiod_line_config* lines, const unsigned* offsets,
                                               size_t count, gpiod_line_settings* settings);
gpiod_request_config* __real_gpiod_request_config_new();
void __real_gpiod_request_config_free(gpiod_request_config* config);

gpiod_chip* __wrap_gpiod_chip_open(const char* path) {
  if (GpioModel::current() == nullptr || std::string_view{path} != "/dev/gpiochip_model") {
    return __real_gpiod_chip_open(path);
  }
  return may_go_on() ? made(new gpiod_chip) : nullptr;
}
void __wrap_gpiod_chip_close(gpiod_chip* chip) {
  given_back(chip);
  delete chip;
}
gpiod_line_settings* __wrap_gpiod_line_settings_new() {
  return may_go_on() ? made(__real_gpiod_line_settings_new()) : nullptr;
}
void __wrap_gpiod_line_settings_free(gpiod_line_settings* settings) {
  given_back(settings);
  __real_gpiod_line_settings_free(settings);
}
int __wrap_gpiod_line_settings_set_direction(gpiod_line_settings* settings,
                                             gpiod_line_direction direction) {
  return may_go_on() ? __real_gpiod_line_settings_set_direction(settings, direction) : -1;
}
int __wrap_gpiod_line_settings_set_edge_detection(gpiod_line_settings* settings,
                                                  gpiod_line_edge edge) {
  return may_go_on() ? __real_gpiod_line_settings_set_edge_detection(settings, edge) : -1;
}
int __wrap_gpiod_line_settings_set_event_clock(gpiod_line_settings* settings,
                                               gpiod_line_clock clock) {
  return may_go_on() ? __real_gpiod_line_settings_set_event_clock(settings, clock) : -1;
}
int __wrap_gpiod_line_settings_set_output_value(gpiod_line_settings* settings,
                                                gpiod_line_value value) {
  return may_go_on() ? __real_gpiod_line_settings_set_output_value(settings, value) : -1;
}
gpiod_line_config* __wrap_gpiod_line_config_new() {
  return may_go_on() ? made(__real_gpiod_line_config_new()) : nullptr;
}
void __wrap_gpiod_line_config_free(gpiod_line_config* lines) {
  given_back(lines);
  __real_gpiod_line_config_free(lines);
}
int __wrap_gpiod_line_config_add_line_settings(gpiod_line_config* lines, const unsigned* offsets,
                                               size_t count, gpiod_line_settings* settings) {
  if (!may_go_on()) return -1;
  return __real_gpiod_line_config_add_line_settings(lines, offsets, count, settings);
}
gpiod_request_config* __wrap_gpiod_request_config_new() {
  return may_go_on() ? made(__real_gpiod_request_config_new()) : nullptr;
}
void __wrap_gpiod_request_config_free(gpiod_request_config* config) {
  given_back(config);
  __real_gpiod_request_config_free(config);
}
gpiod_line_request* __wrap_gpiod_chip_request_lines(gpiod_chip*, gpiod_request_config* config,
                                                    gpiod_line_config* lines) {
  if (!may_go_on()) return nullptr;
  GpioModel& model = *GpioModel::current();
  std::vector<unsigned> offsets(gpiod_line_config_get_num_configured_offsets(lines));
  gpiod_line_config_get_configured_offsets(lines, offsets.data(), offsets.size());
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    if (request_line(lines, offsets[i])) continue;
    const int error = errno;
    for (std::size_t j = 0; j < i; ++j) model.release(offsets[j]);
    errno = error;
    return nullptr;
  }
  model.use_one_queue(gpiod_request_config_get_event_buffer_size(config));
  return made(new gpiod_line_request{offsets});
}
void __wrap_gpiod_line_request_release(gpiod_line_request* request) {
  for (const unsigned offset : request->offsets) GpioModel::current()->release(offset);
  given_back(request);
  delete request;
}
int __wrap_gpiod_line_request_get_fd(gpiod_line_request* request) {
  return GpioModel::current()->descriptor(request->offsets.front());
}
int __wrap_gpiod_line_request_set_value(gpiod_line_request*, unsigned offset,
                                        gpiod_line_value value) {
  return GpioModel::current()->set(offset, value == GPIOD_LINE_VALUE_ACTIVE) ? 0 : -1;
}
gpiod_edge_event_buffer* __wrap_gpiod_edge_event_buffer_new(size_t capacity) {
  return may_go_on() ? made(new gpiod_edge_event_buffer{{}, capacity}) : nullptr;
}
void __wrap_gpiod_edge_event_buffer_free(gpiod_edge_event_buffer* buffer) {
  given_back(buffer);
  delete buffer;
}
int __wrap_gpiod_line_request_read_edge_events(gpiod_line_request* request,
                                               gpiod_edge_event_buffer* buffer, size_t most) {
  if (!may_go_on()) return -1;
  buffer->events.clear();
  ModelEdge edge;
  while (buffer->events.size() < std::min(most, buffer->capacity) &&
         GpioModel::current()->take(request->offsets.front(), edge)) {
    buffer->events.push_back({edge});
  }
  return buffer->events.empty() ? -1 : static_cast<int>(buffer->events.size());
}
gpiod_edge_event* __wrap_gpiod_edge_event_buffer_get_event(gpiod_edge_event_buffer* buffer,
                                                           unsigned long index) {
  return &buffer->events.at(index);
}
unsigned __wrap_gpiod_edge_event_get_line_offset(gpiod_edge_event* event) {
  return event->edge.offset;
}
gpiod_edge_event_type __wrap_gpiod_edge_event_get_event_type(gpiod_edge_event* event) {
  return event->edge.rising ? GPIOD_EDGE_EVENT_RISING_EDGE : GPIOD_EDGE_EVENT_FALLING_EDGE;
}
uint64_t __wrap_gpiod_edge_event_get_timestamp_ns(gpiod_edge_event* event) {
  return static_cast<uint64_t>(event->edge.monotonic_ns);
}
unsigned long __wrap_gpiod_edge_event_get_line_seqno(gpiod_edge_event* event) {
  return event->edge.number;
}
}
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
