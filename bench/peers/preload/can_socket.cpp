// SPDX-License-Identifier: MIT
// Preloaded where the kernel has no CAN. canplayer opens and binds a CAN socket even when it only
// writes to its standard output: it gets a socket that nobody listens to, with an interface of any
// name, and what it sends there is gone without a call of the kernel, so that parsing is left.
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdarg>

extern "C" int socket(int domain, int type, int protocol) noexcept {
  if (domain == AF_CAN)
    return static_cast<int>(::syscall(SYS_socket, AF_UNIX, SOCK_DGRAM | (type & SOCK_CLOEXEC), 0));
  return static_cast<int>(::syscall(SYS_socket, domain, type, protocol));
}

extern "C" int bind(int fd, const sockaddr* address, socklen_t length) noexcept {
  if (address->sa_family == AF_CAN) return 0;
  return static_cast<int>(::syscall(SYS_bind, fd, address, length));
}

extern "C" ssize_t sendto(int fd, const void* data, size_t size, int flags, const sockaddr* address,
                          socklen_t length) {
  if (address != nullptr && address->sa_family == AF_CAN) return static_cast<ssize_t>(size);
  return ::syscall(SYS_sendto, fd, data, size, flags, address, length);
}

extern "C" int ioctl(int fd, unsigned long request, ...) noexcept {
  va_list words;
  va_start(words, request);
  void* argument = va_arg(words, void*);
  va_end(words);
  if (request == SIOCGIFINDEX) {
    static_cast<ifreq*>(argument)->ifr_ifindex = 1;
    return 0;
  }
  return static_cast<int>(::syscall(SYS_ioctl, fd, request, argument));
}
