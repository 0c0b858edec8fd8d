// SPDX-License-Identifier: MIT
#include "tests/fault/gpiod_model.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "tests/fault/fault_plan.hpp"

namespace dampline::fault {
namespace {
GpioModel* the_model = nullptr;
}

GpioModel::GpioModel() {
  for (int& descriptor : descriptors_) descriptor = ::eventfd(0, EFD_CLOEXEC);
  the_model = this;
}

GpioModel::~GpioModel() {
  for (const int descriptor : descriptors_) ::close(descriptor);
  the_model = nullptr;
}

GpioModel* GpioModel::current() { return the_model; }

void GpioModel::signal(std::size_t queue) const {
  static_cast<void>(::eventfd_write(descriptors_.at(queue), 1));
}

void GpioModel::edge(unsigned offset, bool rising, std::int64_t monotonic_ns) {
  Line& line = lines_.at(offset);
  if (!line.in_use || !(rising ? line.rising : line.falling)) return;
  const ModelEdge edge{offset, rising, monotonic_ns, ++line.number};
  const std::size_t queue = queue_of(offset);
  const std::size_t limit = one_queue_ > 0 ? one_queue_ : kQueueV1;
  if (queues_.at(queue).size() == limit) {
    if (one_queue_ == 0) return;  // the newest is lost
    queues_.at(queue).pop_front();
  }
  queues_.at(queue).push_back(edge);
  signal(queue);
}

void GpioModel::remove() {
  removed_ = true;
  for (std::size_t queue = 0; queue < kLines; ++queue) signal(queue);
}

int GpioModel::lines_in_use() const {
  return static_cast<int>(
      std::count_if(lines_.begin(), lines_.end(), [](const Line& l) { return l.in_use; }));
}

bool GpioModel::may_go_on() {
  if (must_fail(Call::kGpio)) return false;
  if (removed_) errno = ENODEV;
  return !removed_;
}

bool GpioModel::request(const Wish& wish) {
  errno = wish.offset >= kLines ? EINVAL : EBUSY;
  if (wish.offset >= kLines || lines_.at(wish.offset).in_use) return false;
  lines_.at(wish.offset) = {.in_use = true,
                            .rising = wish.rising,
                            .falling = wish.falling,
                            .active_low = wish.active_low};
  return true;
}

void GpioModel::release(unsigned offset) { lines_.at(offset).in_use = false; }

bool GpioModel::set(unsigned offset, bool active) {
  if (!may_go_on()) return false;
  lines_.at(offset).output = active;
  return true;
}

bool GpioModel::take(unsigned offset, ModelEdge& out) {
  std::deque<ModelEdge>& queue = queues_.at(queue_of(offset));
  if (queue.empty()) {
    errno = EAGAIN;
    return false;
  }
  out = queue.front();
  queue.pop_front();
  eventfd_t value = 0;
  if (queue.empty()) static_cast<void>(::eventfd_read(descriptor(offset), &value));
  return true;
}

}  // namespace dampline::fault
