// SPDX-License-Identifier: MIT
// The wraps of calls for sockets.
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <cstdarg>
#include <cstring>

#include "tests/fault/can_kernel.hpp"
#include "tests/fault/fault_plan.hpp"

using dampline::fault::Call;
using dampline::fault::CanKernel;
using dampline::fault::must_fail;

namespace {

CanKernel* owner_of(int file) {
  CanKernel* const kernel = CanKernel::current();
  return kernel != nullptr && kernel->owns(file) ? kernel : nullptr;
}

}  // namespace

// The linker's own names.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
extern "C" {
int __real_socket(int domain, int type, int protocol);
int __real_setsockopt(int file, int level, int name, const void* value, socklen_t size);
int __real_getsockopt(int file, int level, int name, void* value, socklen_t* size);
int __real_bind(int file, const sockaddr* address, socklen_t size);
int __real_ioctl(int file, unsigned long request, ...);
int __real_recvmmsg(int file, mmsghdr* messages, unsigned count, int flags, timespec* timeout);
int __real_sendmmsg(int file, mmsghdr* messages, unsigned count, int flags);
ssize_t __real_send(int file, const void* data, size_t bytes, int flags);
ssize_t __real_recv(int file, void* data, size_t bytes, int flags);

int __wrap_socket(int domain, int type, int protocol) {
  if (must_fail(Call::kSocket)) return -1;
  CanKernel* const kernel = CanKernel::current();
  if (domain == PF_CAN && kernel != nullptr) return kernel->open_socket();
  return __real_socket(domain, type, protocol);
}
int __wrap_setsockopt(int file, int level, int name, const void* value, socklen_t size) {
  if (must_fail(Call::kSetsockopt)) return -1;
  if (CanKernel* const kernel = owner_of(file)) {
    return kernel->set_option(file, level, name, value, size);
  }
  return __real_setsockopt(file, level, name, value, size);
}
int __wrap_getsockopt(int file, int level, int name, void* value, socklen_t* size) {
  if (must_fail(Call::kGetsockopt)) return -1;
  if (CanKernel* const kernel = owner_of(file)) {
    return kernel->get_option(file, level, name, value, size);
  }
  return __real_getsockopt(file, level, name, value, size);
}
int __wrap_bind(int file, const sockaddr* address, socklen_t size) {
  if (must_fail(Call::kBind)) return -1;
  if (CanKernel* const kernel = owner_of(file)) {
    sockaddr_can can{};
    std::memcpy(&can, address, size);
    return kernel->bind_socket(file, can);
  }
  return __real_bind(file, address, size);
}
int __wrap_ioctl(int file, unsigned long request, ...) {
  va_list arguments;
  va_start(arguments, request);
  auto* const argument = va_arg(arguments, void*);
  va_end(arguments);
  if (must_fail(Call::kIoctl)) return -1;
  if (CanKernel* const kernel = owner_of(file)) {
    return kernel->find_interface(static_cast<const char*>(argument), static_cast<int>(request),
                                  argument);
  }
  return __real_ioctl(file, request, argument);
}
int __wrap_recvmmsg(int file, mmsghdr* messages, unsigned count, int flags, timespec* timeout) {
  if (must_fail(Call::kRecvmmsg)) return -1;
  if (CanKernel* const kernel = owner_of(file)) {
    return kernel->receive_messages(file, messages, count);
  }
  return __real_recvmmsg(file, messages, count, flags, timeout);
}
int __wrap_sendmmsg(int file, mmsghdr* messages, unsigned count, int flags) {
  if (must_fail(Call::kSendmmsg)) return -1;
  if (CanKernel* const kernel = owner_of(file)) return kernel->send_messages(file, messages, count);
  return __real_sendmmsg(file, messages, count, flags);
}
ssize_t __wrap_send(int file, const void* data, size_t bytes, int flags) {
  return must_fail(Call::kSend) ? -1 : __real_send(file, data, bytes, flags);
}
ssize_t __wrap_recv(int file, void* data, size_t bytes, int flags) {
  return must_fail(Call::kRecv) ? -1 : __real_recv(file, data, bytes, flags);
}
}
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
