// SPDX-License-Identifier: MIT
// The wraps of calls for waiting.
#include <poll.h>

#include <csignal>
#include <cstdarg>

#include "tests/fault/fault_plan.hpp"

using dampline::fault::Call;
using dampline::fault::must_fail;

// The linker's own names.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
extern "C" {
int __real_fcntl(int file, int command, ...);
int __real_fcntl64(int file, int command, ...);
int __real_ppoll(pollfd* files, nfds_t count, const timespec* timeout, const sigset_t* signals);

// The argument is there only with some commands; passing on what is not there is harmless on every
// ABI that we build for.
#define DAMPLINE_ARGUMENT(argument)                \
  va_list arguments;                               \
  va_start(arguments, command);                    \
  auto* const argument = va_arg(arguments, void*); \
  va_end(arguments)

int __wrap_fcntl(int file, int command, ...) {
  DAMPLINE_ARGUMENT(argument);
  return must_fail(Call::kFcntl) ? -1 : __real_fcntl(file, command, argument);
}
int __wrap_fcntl64(int file, int command, ...) {
  DAMPLINE_ARGUMENT(argument);
  return must_fail(Call::kFcntl) ? -1 : __real_fcntl64(file, command, argument);
}
int __wrap_ppoll(pollfd* files, nfds_t count, const timespec* timeout, const sigset_t* signals) {
  return must_fail(Call::kPpoll) ? -1 : __real_ppoll(files, count, timeout, signals);
}

#undef DAMPLINE_ARGUMENT
}
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
