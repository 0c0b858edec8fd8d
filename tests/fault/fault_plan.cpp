// SPDX-License-Identifier: MIT
#include "tests/fault/fault_plan.hpp"

#include <array>
#include <atomic>

namespace dampline::fault {
namespace {

struct Slot {
  std::atomic<bool> armed{false};
  std::atomic<std::uint64_t> nth{kNever};
  std::atomic<int> error{0};
  std::atomic<bool> for_ever{false};
  std::atomic<std::uint64_t> calls{0};
  std::atomic<std::uint64_t> fired{0};
};

std::array<Slot, static_cast<std::size_t>(Call::kCount)> slots;

}  // namespace

ArmedFault::ArmedFault(const Fault& fault) noexcept : kind_{static_cast<std::size_t>(fault.call)} {
  Slot& slot = slots.at(kind_);
  slot.nth = fault.nth;
  slot.error = fault.error;
  slot.for_ever = fault.for_ever;
  slot.calls = 0;
  slot.fired = 0;
  slot.armed = true;
}

ArmedFault::~ArmedFault() { slots.at(kind_).armed = false; }

std::uint64_t ArmedFault::calls() const noexcept { return slots.at(kind_).calls; }
std::uint64_t ArmedFault::fired() const noexcept { return slots.at(kind_).fired; }

Verdict judge(Call call) noexcept {
  Slot& slot = slots.at(static_cast<std::size_t>(call));
  if (!slot.armed) return {};
  const std::uint64_t number = ++slot.calls;
  const bool fails = slot.for_ever ? number >= slot.nth : number == slot.nth;
  if (!fails) return {};
  ++slot.fired;
  return {true, slot.error};
}

bool must_fail(Call call) noexcept {
  const Verdict verdict = judge(call);
  if (!verdict.fails || verdict.is_short()) return false;
  errno = verdict.error;
  return true;
}

bool must_fail(Call call, std::size_t& bytes) noexcept {
  const Verdict verdict = judge(call);
  if (verdict.is_short() && bytes > 1) bytes /= 2;
  if (!verdict.fails || verdict.is_short()) return false;
  errno = verdict.error;
  return true;
}

}  // namespace dampline::fault
