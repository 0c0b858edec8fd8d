// SPDX-License-Identifier: MIT
// System calls that fail on demand. The linker (--wrap, see CMakeLists.txt) sends this program's
// own calls through here, so the driver's code is the shipped one. Calls made inside shared
// libraries, such as those of std::ofstream or fmt, are not seen.
#pragma once
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace dampline::fault {

/// Kinds of calls. Add a kind before kCount, its wrap in *_calls.cpp and its name in
/// CMakeLists.txt.
enum class Call : std::uint8_t {
  kOpen,
  kClose,  ///< closes all the same, as the kernel does
  kRead,   ///< also pread
  kWrite,  ///< also pwrite
  kFsync,
  kFdatasync,
  kFtruncate,
  kFallocate,
  kRename,
  kUnlink,
  kFlock,
  kMmap,
  kMlockall,
  kSetschedparam,  ///< of pthread; returns the error
  kFcntl,
  kPpoll,
  kGpio,  ///< any call of libgpiod that the driver makes and that can fail
  kSocket,
  kSetsockopt,
  kGetsockopt,
  kBind,
  kIoctl,
  kRecvmmsg,
  kSendmmsg,
  kSend,
  kRecv,
  kCount,
};

constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();
/// In place of an errno: a read or write does half of what was asked for, at least one byte.
constexpr int kShort = 0;

/// The Nth call of a kind, from 1, fails; with `for_ever` all later ones fail, too.
struct Fault {
  Call call{Call::kCount};
  std::uint64_t nth{1};
  int error{EIO};
  bool for_ever{false};
};

/// While one is alive its fault is armed, for all threads, and calls of its kind are counted from
/// 0. Faults of different kinds may be armed together.
class ArmedFault {
 public:
  explicit ArmedFault(const Fault& fault) noexcept;
  ~ArmedFault();
  ArmedFault(const ArmedFault&) = delete;
  ArmedFault& operator=(const ArmedFault&) = delete;
  /// Calls of this kind since it was armed.
  [[nodiscard]] std::uint64_t calls() const noexcept;
  /// How many of them were made to fail.
  [[nodiscard]] std::uint64_t fired() const noexcept;

 private:
  std::size_t kind_;
};

/// For the wraps: what is to become of this call.
struct Verdict {
  bool fails{false};
  int error{0};
  [[nodiscard]] bool is_short() const noexcept { return fails && error == kShort; }
};
[[nodiscard]] Verdict judge(Call call) noexcept;

/// For the wraps: counts the call and sets errno where it is to fail. A short one does not fail.
[[nodiscard]] bool must_fail(Call call) noexcept;
/// The same for a call that moves `bytes`; a short one moves half of them.
[[nodiscard]] bool must_fail(Call call, std::size_t& bytes) noexcept;

}  // namespace dampline::fault
