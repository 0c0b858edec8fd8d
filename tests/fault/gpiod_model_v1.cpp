// SPDX-License-Identifier: MIT
// libgpiod 1 in front of the model.
#include <gpiod.h>

#include <cerrno>
#include <memory>
#include <string_view>
#include <vector>

#include "tests/fault/gpiod_model.hpp"

using dampline::fault::GpioModel;
using dampline::fault::ModelEdge;

struct gpiod_line {
  unsigned offset;
  bool requested;
};
struct gpiod_chip {
  std::vector<std::unique_ptr<gpiod_line>> lines;
};

namespace {

bool may_go_on() { return GpioModel::current()->may_go_on(); }

}  // namespace

// The linker's own names.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
extern "C" {
gpiod_chip* __real_gpiod_chip_open(const char* path);

gpiod_chip* __wrap_gpiod_chip_open(const char* path) {
  if (GpioModel::current() == nullptr || std::string_view{path} != "/dev/gpiochip_model") {
    return __real_gpiod_chip_open(path);
  }
  if (!may_go_on()) return nullptr;
  GpioModel::current()->made(1);
  return new gpiod_chip;
}
void __wrap_gpiod_chip_close(gpiod_chip* chip) {
  for (const auto& line : chip->lines) {
    if (line->requested) GpioModel::current()->release(line->offset);
  }
  GpioModel::current()->made(-1);
  delete chip;
}
gpiod_line* __wrap_gpiod_chip_get_line(gpiod_chip* chip, unsigned offset) {
  if (!may_go_on()) return nullptr;
  errno = EINVAL;
  if (offset >= GpioModel::kLines) return nullptr;
  chip->lines.push_back(std::make_unique<gpiod_line>(gpiod_line{offset, false}));
  return chip->lines.back().get();
}
int __wrap_gpiod_line_request(gpiod_line* line, const gpiod_line_request_config* config, int) {
  if (!may_go_on()) return -1;
  const int type = config->request_type;
  const bool both = type == GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES;
  line->requested = GpioModel::current()->request(
      {.offset = line->offset,
       .rising = both || type == GPIOD_LINE_REQUEST_EVENT_RISING_EDGE,
       .falling = both || type == GPIOD_LINE_REQUEST_EVENT_FALLING_EDGE,
       .active_low = (config->flags & GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW) != 0});
  return line->requested ? 0 : -1;
}
int __wrap_gpiod_line_event_get_fd(gpiod_line* line) {
  return may_go_on() ? GpioModel::current()->descriptor(line->offset) : -1;
}
int __wrap_gpiod_line_event_read_fd_multiple(int fd, gpiod_line_event* events, unsigned most) {
  GpioModel& model = *GpioModel::current();
  if (!may_go_on()) return -1;
  unsigned offset = 0;
  while (model.descriptor(offset) != fd) ++offset;
  int count = 0;
  ModelEdge edge;
  while (count < static_cast<int>(most) && model.take(offset, edge)) {
    events[count++] = {
        .ts = {.tv_sec = edge.monotonic_ns / 1'000'000'000,
               .tv_nsec = edge.monotonic_ns % 1'000'000'000},
        .event_type = edge.rising ? GPIOD_LINE_EVENT_RISING_EDGE : GPIOD_LINE_EVENT_FALLING_EDGE};
  }
  return count > 0 ? count : -1;
}
int __wrap_gpiod_line_set_value(gpiod_line* line, int value) {
  return GpioModel::current()->set(line->offset, value != 0) ? 0 : -1;
}
}
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
