// SPDX-License-Identifier: MIT
// Preloaded where the kernel has no CAN: canplayer opens and binds a CAN socket even when it only
// writes to its standard output. It gets a socket that nobody listens to.
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

extern "C" int socket(int domain, int type, int protocol) noexcept {
  if (domain == AF_CAN)
    return static_cast<int>(::syscall(SYS_socket, AF_UNIX, SOCK_DGRAM | (type & SOCK_CLOEXEC), 0));
  return static_cast<int>(::syscall(SYS_socket, domain, type, protocol));
}

extern "C" int bind(int fd, const sockaddr* address, socklen_t length) noexcept {
  if (address->sa_family == AF_CAN) return 0;
  return static_cast<int>(::syscall(SYS_bind, fd, address, length));
}
