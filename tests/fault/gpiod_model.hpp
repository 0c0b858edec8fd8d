// SPDX-License-Identifier: MIT
// A GPIO chip that exists in this program only. The linker sends the driver's calls of libgpiod
// here (gpiod_model_v1.cpp or gpiod_model_v2.cpp, by the library that the build found), so the
// driver's code is the shipped one. Each call may be made to fail by Call::kGpio.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>

namespace dampline::fault {

struct ModelEdge {
  unsigned offset{0};
  bool rising{false};
  std::int64_t monotonic_ns{0};
  std::uint32_t number{0};  ///< of its line, from 1
};

/// One at a time; the library's calls find it while it is alive.
class GpioModel {
 public:
  static constexpr unsigned kLines = 8;
  /// What libgpiod 1 keeps for a line.
  static constexpr std::size_t kQueueV1 = 16;

  /// Named "/dev/gpiochip_model".
  GpioModel();
  ~GpioModel();
  GpioModel(const GpioModel&) = delete;
  GpioModel& operator=(const GpioModel&) = delete;

  // The test's side.
  /// As the kernel does it: kept if there is room, else lost as this version loses.
  void edge(unsigned offset, bool rising, std::int64_t monotonic_ns);
  /// The chip is unplugged: every call ends with ENODEV from now on.
  void remove();
  [[nodiscard]] bool output(unsigned offset) const { return lines_.at(offset).output; }
  [[nodiscard]] bool active_low(unsigned offset) const { return lines_.at(offset).active_low; }
  /// Objects of the library that were made and not yet given back.
  [[nodiscard]] int objects() const { return objects_; }
  [[nodiscard]] int lines_in_use() const;

  // The library's side.
  static GpioModel* current();
  /// False, with errno, where the plan or an unplugged chip makes a call fail.
  bool may_go_on();
  void made(int objects) { objects_ += objects; }
  struct Wish {
    unsigned offset{0};
    bool rising{false};
    bool falling{false};
    bool active_low{false};
  };
  /// False, with errno: no such line, or it is in use.
  bool request(const Wish& wish);
  void release(unsigned offset);
  bool set(unsigned offset, bool active);
  [[nodiscard]] int descriptor(unsigned offset) const { return descriptors_.at(queue_of(offset)); }
  /// Takes the oldest edge of that queue; false, with errno, when there is none.
  bool take(unsigned offset, ModelEdge& out);
  /// libgpiod 2: one queue of this size for all lines; 0: one of 16 for each.
  void use_one_queue(std::size_t size) { one_queue_ = size; }

 private:
  struct Line {
    bool in_use{false};
    bool rising{false};
    bool falling{false};
    bool active_low{false};
    bool output{false};
    std::uint32_t number{0};
  };
  [[nodiscard]] std::size_t queue_of(unsigned offset) const { return one_queue_ > 0 ? 0 : offset; }
  void signal(std::size_t queue) const;

  std::array<Line, kLines> lines_{};
  std::array<std::deque<ModelEdge>, kLines> queues_{};
  std::array<int, kLines> descriptors_{};
  std::size_t one_queue_{0};
  int objects_{0};
  bool removed_{false};
};

}  // namespace dampline::fault
