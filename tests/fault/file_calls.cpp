// SPDX-License-Identifier: MIT
// The wraps of calls for files and memory.
#include <pthread.h>
#include <sys/types.h>

#include <cerrno>
#include <cstdarg>

#include "tests/fault/can_kernel.hpp"
#include "tests/fault/fault_plan.hpp"

using dampline::fault::Call;
using dampline::fault::must_fail;

// The linker's own names.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
extern "C" {
int __real_open(const char* path, int flags, ...);
int __real_open64(const char* path, int flags, ...);
int __real_openat(int folder, const char* path, int flags, ...);
int __real_openat64(int folder, const char* path, int flags, ...);
int __real_close(int file);
ssize_t __real_read(int file, void* data, size_t bytes);
ssize_t __real_pread(int file, void* data, size_t bytes, off_t offset);
ssize_t __real_pread64(int file, void* data, size_t bytes, off_t offset);
ssize_t __real_write(int file, const void* data, size_t bytes);
ssize_t __real_pwrite(int file, const void* data, size_t bytes, off_t offset);
ssize_t __real_pwrite64(int file, const void* data, size_t bytes, off_t offset);
int __real_fsync(int file);
int __real_fdatasync(int file);
int __real_ftruncate(int file, off_t bytes);
int __real_ftruncate64(int file, off_t bytes);
int __real_posix_fallocate(int file, off_t offset, off_t bytes);
int __real_posix_fallocate64(int file, off_t offset, off_t bytes);
int __real_rename(const char* from, const char* to);
int __real_unlink(const char* path);
int __real_unlinkat(int folder, const char* path, int flags);
int __real_flock(int file, int operation);
void* __real_mmap(void* at, size_t bytes, int protection, int flags, int file, off_t offset);
void* __real_mmap64(void* at, size_t bytes, int protection, int flags, int file, off_t offset);
int __real_mlockall(int flags);
int __real_pthread_setschedparam(pthread_t thread, int policy, const sched_param* parameter);

// The mode is there only with O_CREAT; reading it without is harmless on every ABI that we build
// for, and passing it on is, too.
#define DAMPLINE_MODE(mode)                      \
  va_list arguments;                             \
  va_start(arguments, flags);                    \
  const auto mode = va_arg(arguments, unsigned); \
  va_end(arguments)

int __wrap_open(const char* path, int flags, ...) {
  DAMPLINE_MODE(mode);
  return must_fail(Call::kOpen) ? -1 : __real_open(path, flags, mode);
}
int __wrap_open64(const char* path, int flags, ...) {
  DAMPLINE_MODE(mode);
  return must_fail(Call::kOpen) ? -1 : __real_open64(path, flags, mode);
}
int __wrap_openat(int folder, const char* path, int flags, ...) {
  DAMPLINE_MODE(mode);
  return must_fail(Call::kOpen) ? -1 : __real_openat(folder, path, flags, mode);
}
int __wrap_openat64(int folder, const char* path, int flags, ...) {
  DAMPLINE_MODE(mode);
  return must_fail(Call::kOpen) ? -1 : __real_openat64(folder, path, flags, mode);
}
int __wrap_close(int file) {
  const bool fails = must_fail(Call::kClose);
  const int error = errno;
  const int result = __real_close(file);
  dampline::fault::CanKernel* const kernel = dampline::fault::CanKernel::current();
  if (kernel != nullptr) kernel->forget(file);
  if (!fails) return result;
  errno = error;
  return -1;
}
ssize_t __wrap_read(int file, void* data, size_t bytes) {
  return must_fail(Call::kRead, bytes) ? -1 : __real_read(file, data, bytes);
}
ssize_t __wrap_pread(int file, void* data, size_t bytes, off_t offset) {
  return must_fail(Call::kRead, bytes) ? -1 : __real_pread(file, data, bytes, offset);
}
ssize_t __wrap_pread64(int file, void* data, size_t bytes, off_t offset) {
  return must_fail(Call::kRead, bytes) ? -1 : __real_pread64(file, data, bytes, offset);
}
ssize_t __wrap_write(int file, const void* data, size_t bytes) {
  return must_fail(Call::kWrite, bytes) ? -1 : __real_write(file, data, bytes);
}
ssize_t __wrap_pwrite(int file, const void* data, size_t bytes, off_t offset) {
  return must_fail(Call::kWrite, bytes) ? -1 : __real_pwrite(file, data, bytes, offset);
}
ssize_t __wrap_pwrite64(int file, const void* data, size_t bytes, off_t offset) {
  return must_fail(Call::kWrite, bytes) ? -1 : __real_pwrite64(file, data, bytes, offset);
}
int __wrap_fsync(int file) { return must_fail(Call::kFsync) ? -1 : __real_fsync(file); }
int __wrap_fdatasync(int file) { return must_fail(Call::kFdatasync) ? -1 : __real_fdatasync(file); }
int __wrap_ftruncate(int file, off_t bytes) {
  return must_fail(Call::kFtruncate) ? -1 : __real_ftruncate(file, bytes);
}
int __wrap_ftruncate64(int file, off_t bytes) {
  return must_fail(Call::kFtruncate) ? -1 : __real_ftruncate64(file, bytes);
}
// These two return the error itself.
int __wrap_posix_fallocate(int file, off_t offset, off_t bytes) {
  return must_fail(Call::kFallocate) ? errno : __real_posix_fallocate(file, offset, bytes);
}
int __wrap_posix_fallocate64(int file, off_t offset, off_t bytes) {
  return must_fail(Call::kFallocate) ? errno : __real_posix_fallocate64(file, offset, bytes);
}
int __wrap_rename(const char* from, const char* to) {
  return must_fail(Call::kRename) ? -1 : __real_rename(from, to);
}
int __wrap_unlink(const char* path) { return must_fail(Call::kUnlink) ? -1 : __real_unlink(path); }
int __wrap_unlinkat(int folder, const char* path, int flags) {
  return must_fail(Call::kUnlink) ? -1 : __real_unlinkat(folder, path, flags);
}
int __wrap_flock(int file, int operation) {
  return must_fail(Call::kFlock) ? -1 : __real_flock(file, operation);
}
void* __wrap_mmap(void* at, size_t bytes, int protection, int flags, int file, off_t offset) {
  if (must_fail(Call::kMmap)) return reinterpret_cast<void*>(-1);
  return __real_mmap(at, bytes, protection, flags, file, offset);
}
void* __wrap_mmap64(void* at, size_t bytes, int protection, int flags, int file, off_t offset) {
  if (must_fail(Call::kMmap)) return reinterpret_cast<void*>(-1);
  return __real_mmap64(at, bytes, protection, flags, file, offset);
}
int __wrap_mlockall(int flags) { return must_fail(Call::kMlockall) ? -1 : __real_mlockall(flags); }
int __wrap_pthread_setschedparam(pthread_t thread, int policy, const sched_param* parameter) {
  if (must_fail(Call::kSetschedparam)) return errno;
  return __real_pthread_setschedparam(thread, policy, parameter);
}

#undef DAMPLINE_MODE
}
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
