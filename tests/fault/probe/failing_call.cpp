// SPDX-License-Identifier: MIT
// Runs a program in which one system call fails, of any of its threads; see tests/fault/calls.
//   failing_call --list FILE COMMAND...                    which calls there are, and what may
//   befall them failing_call CALL OBJECT NUMBER ERROR COMMAND...       the NUMBERth such call fails
//   with that errno
// Calls go by their name and by what they are on: a path, what a descriptor leads to, or nothing.
// FILE gets a line for each such pair: call, object, how many, errors. Calls of the loader, before
// the program's own, are left alone. Ends with the program's status, 128 + its signal; 119: there
// was no such call.
#include <fcntl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace {

/// What a call is on.
enum class On : std::uint8_t { kNothing, kPath, kPathAt, kDescriptor, kMemory };

struct Kind {
  const char* name;
  On on;
  std::vector<int> errors;
};

/// Calls that are not here cannot fail where the program is right (futex, rt_sigaction), or what
/// becomes of them is nobody's concern (madvise).
const std::map<long, Kind>& kinds() {
  static const std::map<long, Kind> all{
      {SYS_open, {"open", On::kPath, {EACCES, EMFILE, EIO, EINTR}}},
      {SYS_openat, {"openat", On::kPathAt, {EACCES, EMFILE, EIO, EINTR}}},
      {SYS_read, {"read", On::kDescriptor, {EIO, EINTR}}},
      {SYS_readv, {"readv", On::kDescriptor, {EIO, EINTR}}},
      {SYS_pread64, {"pread64", On::kDescriptor, {EIO, EINTR}}},
      {SYS_getdents64, {"getdents64", On::kDescriptor, {EIO}}},
      {SYS_lseek, {"lseek", On::kDescriptor, {EIO}}},
      {SYS_write, {"write", On::kDescriptor, {EIO, ENOSPC, EINTR}}},
      {SYS_writev, {"writev", On::kDescriptor, {EIO, ENOSPC, EINTR}}},
      {SYS_pwrite64, {"pwrite64", On::kDescriptor, {EIO, ENOSPC, EINTR}}},
      {SYS_fsync, {"fsync", On::kDescriptor, {EIO, ENOSPC}}},
      {SYS_fdatasync, {"fdatasync", On::kDescriptor, {EIO, ENOSPC}}},
      {SYS_ftruncate, {"ftruncate", On::kDescriptor, {EIO}}},
      {SYS_fallocate, {"fallocate", On::kDescriptor, {ENOSPC, EOPNOTSUPP, EINTR}}},
      {SYS_fadvise64, {"fadvise64", On::kDescriptor, {EINVAL}}},
      {SYS_close, {"close", On::kDescriptor, {EIO}}},
      {SYS_fcntl, {"fcntl", On::kDescriptor, {EMFILE}}},
      {SYS_flock, {"flock", On::kDescriptor, {EWOULDBLOCK, ENOLCK}}},
      {SYS_mkdir, {"mkdir", On::kPath, {EACCES, ENOSPC}}},
      {SYS_mkdirat, {"mkdirat", On::kPathAt, {EACCES, ENOSPC}}},
      {SYS_rmdir, {"rmdir", On::kPath, {EIO}}},
      {SYS_unlink, {"unlink", On::kPath, {EIO}}},
      {SYS_unlinkat, {"unlinkat", On::kPathAt, {EIO}}},
      {SYS_rename, {"rename", On::kPath, {EIO, ENOSPC}}},
      {SYS_renameat, {"renameat", On::kPathAt, {EIO, ENOSPC}}},
      {SYS_renameat2, {"renameat2", On::kPathAt, {EIO, ENOSPC, EINVAL}}},
      {SYS_linkat, {"linkat", On::kPathAt, {EPERM}}},
      {SYS_fchmodat, {"fchmodat", On::kPathAt, {EPERM}}},
      {SYS_newfstatat, {"newfstatat", On::kPathAt, {EACCES, EIO}}},
      {SYS_statx, {"statx", On::kPathAt, {EACCES, ENOSYS}}},
      {SYS_fstat, {"fstat", On::kDescriptor, {EIO}}},
      {SYS_access, {"access", On::kPath, {EACCES}}},
      {SYS_readlink, {"readlink", On::kPath, {EACCES}}},
      {SYS_getcwd, {"getcwd", On::kNothing, {ENOENT}}},
      {SYS_brk, {"brk", On::kMemory, {ENOMEM}}},
      {SYS_mmap, {"mmap", On::kMemory, {ENOMEM}}},
      {SYS_mremap, {"mremap", On::kMemory, {ENOMEM}}},
      {SYS_mprotect, {"mprotect", On::kMemory, {ENOMEM}}},
      {SYS_mlockall, {"mlockall", On::kNothing, {ENOMEM, EPERM}}},
      {SYS_getrandom, {"getrandom", On::kNothing, {EAGAIN, ENOSYS}}},
      {SYS_clone3, {"clone3", On::kNothing, {EAGAIN}}},
      {SYS_clone, {"clone", On::kNothing, {EAGAIN}}},
      {SYS_sched_setscheduler, {"sched_setscheduler", On::kNothing, {EPERM}}},
      {SYS_sched_getaffinity, {"sched_getaffinity", On::kNothing, {EINVAL}}},
      {SYS_prlimit64, {"prlimit64", On::kNothing, {EPERM}}},
      {SYS_getrusage, {"getrusage", On::kNothing, {EFAULT}}},
      {SYS_clock_nanosleep, {"clock_nanosleep", On::kNothing, {EINTR}}},
      {SYS_socket, {"socket", On::kNothing, {EACCES, EMFILE, ENOBUFS}}},
      {SYS_setsockopt, {"setsockopt", On::kDescriptor, {EPERM, ENOPROTOOPT}}},
      {SYS_getsockopt, {"getsockopt", On::kDescriptor, {ENOPROTOOPT}}},
      {SYS_getsockname, {"getsockname", On::kDescriptor, {ENOBUFS}}},
      {SYS_bind, {"bind", On::kDescriptor, {ENODEV, EADDRINUSE}}},
      {SYS_listen, {"listen", On::kDescriptor, {EADDRINUSE}}},
      {SYS_connect, {"connect", On::kDescriptor, {ECONNREFUSED, EINTR}}},
      {SYS_ioctl, {"ioctl", On::kDescriptor, {EIO, ENODEV}}},
      {SYS_recvmmsg, {"recvmmsg", On::kDescriptor, {ENETDOWN, ENOBUFS, EINTR}}},
      {SYS_recvmsg, {"recvmsg", On::kDescriptor, {ENOBUFS, EINTR}}},
      {SYS_recvfrom, {"recvfrom", On::kDescriptor, {ENOBUFS, EINTR}}},
      {SYS_sendto, {"sendto", On::kDescriptor, {ECONNREFUSED, ENOBUFS, EINTR}}},
      {SYS_sendmsg, {"sendmsg", On::kDescriptor, {ECONNREFUSED, ENOBUFS, EINTR}}},
      {SYS_ppoll, {"ppoll", On::kNothing, {EINTR, ENOMEM}}},
      {SYS_poll, {"poll", On::kNothing, {EINTR, ENOMEM}}},
      {SYS_select, {"select", On::kNothing, {EINTR, ENOMEM}}},
      {SYS_pselect6, {"pselect6", On::kNothing, {EINTR, ENOMEM}}},
      {SYS_epoll_create1, {"epoll_create1", On::kNothing, {EMFILE}}},
      {SYS_epoll_ctl, {"epoll_ctl", On::kDescriptor, {ENOMEM}}},
      {SYS_epoll_wait, {"epoll_wait", On::kDescriptor, {EINTR}}},
      {SYS_eventfd2, {"eventfd2", On::kNothing, {EMFILE}}},
      {SYS_timerfd_create, {"timerfd_create", On::kNothing, {EMFILE}}},
      {SYS_signalfd4, {"signalfd4", On::kNothing, {EMFILE}}},
      {SYS_pipe2, {"pipe2", On::kNothing, {EMFILE}}},
  };
  return all;
}

pid_t program = -1;

std::string link_of(pid_t process, int descriptor) {
  const std::string name = "/proc/" + std::to_string(process) + "/fd/" + std::to_string(descriptor);
  std::array<char, PATH_MAX> target{};
  const ssize_t length = ::readlink(name.c_str(), target.data(), target.size());
  return length < 0 ? std::string{"none"}
                    : std::string(target.data(), static_cast<std::size_t>(length));
}

std::string text_at(pid_t process, std::uint64_t address) {
  std::string text;
  while (address != 0 && text.size() < PATH_MAX) {
    errno = 0;
    const long word = ::ptrace(PTRACE_PEEKDATA, process, address, nullptr);
    if (errno != 0) break;
    std::array<char, sizeof(word)> bytes{};
    std::memcpy(bytes.data(), &word, sizeof(word));
    const std::size_t length = ::strnlen(bytes.data(), bytes.size());
    text.append(bytes.data(), length);
    if (length < bytes.size()) break;
    address += bytes.size();
  }
  return text;
}

/// The same in every run: no process, random name, inode, or folder that the program stands in.
std::string plain(std::string text) {
  static const std::regex random{"[0-9a-f]{16}"};
  static const std::regex number{"([/\\[])[0-9]+(?=[/\\]]|$)"};
  std::array<char, PATH_MAX> here{};
  if (::getcwd(here.data(), here.size()) != nullptr && text.starts_with(here.data())) {
    text.erase(0, std::strlen(here.data()) - 1);
    text[0] = '.';
  }
  text = std::regex_replace(std::regex_replace(text, random, "*"), number, "$1*");
  for (char& c : text)
    if (c == '\t' || c == '\n') c = ' ';
  return text.empty() ? "-" : text;
}

std::string object_of(pid_t thread, const Kind& kind, const user_regs_struct& regs) {
  switch (kind.on) {
    case On::kPath:
      return plain(text_at(thread, regs.rdi));
    case On::kPathAt: {
      const std::string path = text_at(thread, regs.rsi);
      return plain(path.empty() ? link_of(program, static_cast<int>(regs.rdi)) : path);
    }
    case On::kDescriptor:
      return plain(link_of(program, static_cast<int>(regs.rdi)));
    case On::kMemory:
      if (regs.orig_rax == SYS_mmap && static_cast<int>(regs.r8) >= 0)
        return plain(link_of(program, static_cast<int>(regs.r8)));
      return "memory";
    case On::kNothing:
      break;
  }
  return "-";
}

/// Where the loader's code lies.
std::pair<std::uint64_t, std::uint64_t> loader_of(pid_t process) {
  std::ifstream maps{"/proc/" + std::to_string(process) + "/maps"};
  for (std::string line; std::getline(maps, line);) {
    std::uint64_t from = 0;
    std::uint64_t to = 0;
    if (line.find("/ld-linux") == std::string::npos || line.find(" r-xp ") == std::string::npos)
      continue;
    if (std::sscanf(line.c_str(), "%lx-%lx", &from, &to) == 2)
      return {from, to};  // NOLINT(cert-err34-c)
  }
  return {0, 0};
}

using Call = std::pair<std::string, std::string>;

class Tracer {
 public:
  Call wanted;
  std::uint64_t number{0};
  int error{0};

  /// Returns the program's status.
  int follow() {
    ::waitpid(program, nullptr, 0);
    ::ptrace(PTRACE_SETOPTIONS, program, nullptr,
             PTRACE_O_TRACESYSGOOD | PTRACE_O_TRACECLONE | PTRACE_O_EXITKILL);
    resume(program, 0);
    for (;;) {
      int status = 0;
      const pid_t thread = ::waitpid(-1, &status, __WALL);
      if (thread < 0 && errno == EINTR) continue;
      if (thread < 0) return 118;
      if (WIFSTOPPED(status)) {
        stopped(thread, status);
      } else if (thread == program) {
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
      }
    }
  }
  [[nodiscard]] bool happened() const { return done_; }
  [[nodiscard]] const std::map<Call, std::uint64_t>& counts() const { return counts_; }
  [[nodiscard]] static const Kind& kind_of(const std::string& name) {
    for (const auto& [number, kind] : kinds())
      if (name == kind.name) return kind;
    std::abort();
  }

 private:
  void resume(pid_t thread, int signal) const {
    ::ptrace(done_ && !failing_ ? PTRACE_CONT : PTRACE_SYSCALL, thread, nullptr, signal);
  }

  void stopped(pid_t thread, int status) {
    const int signal = WSTOPSIG(status);
    if (signal == (SIGTRAP | 0x80)) {
      if (inside_.erase(thread) == 0) {
        inside_.insert(thread);
        entered(thread);
      } else {
        left(thread);
      }
      return resume(thread, 0);
    }
    const bool first = signal == SIGSTOP && known_.insert(thread).second && thread != program;
    resume(thread, first || signal == SIGTRAP ? 0 : signal);
  }

  void entered(pid_t thread) {
    user_regs_struct regs{};
    if (done_ || ::ptrace(PTRACE_GETREGS, thread, nullptr, &regs) != 0) return;
    const auto kind = kinds().find(static_cast<long>(regs.orig_rax));
    if (loader_.second == 0) loader_ = loader_of(program);
    if (kind == kinds().end() || (regs.rip >= loader_.first && regs.rip < loader_.second)) return;
    if (regs.orig_rax == SYS_fcntl && regs.rsi != F_DUPFD && regs.rsi != F_DUPFD_CLOEXEC) return;
    const Call call{kind->second.name, object_of(thread, kind->second, regs)};
    if (const auto count = ++counts_[call]; call != wanted || count != number) return;
    done_ = true;
    failing_ = thread;
    regs.orig_rax = ~0ULL;  // no such call
    ::ptrace(PTRACE_SETREGS, thread, nullptr, &regs);
  }

  void left(pid_t thread) {
    if (failing_ != thread) return;
    failing_ = 0;
    user_regs_struct regs{};
    ::ptrace(PTRACE_GETREGS, thread, nullptr, &regs);
    regs.rax = static_cast<unsigned long long>(-static_cast<long long>(error));
    if (wanted.first == "brk")
      regs.rax = 0;  // tells it by an address that is not the one asked for
    ::ptrace(PTRACE_SETREGS, thread, nullptr, &regs);
  }

  std::pair<std::uint64_t, std::uint64_t> loader_{0, 0};
  std::map<Call, std::uint64_t> counts_;
  std::set<pid_t> inside_;  ///< a call
  std::set<pid_t> known_;
  pid_t failing_{0};
  bool done_{false};
};

void start(char** command) {
  program = ::fork();
  if (program != 0) return;
  ::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr);
  ::execvp(command[0], command);
  ::_exit(120);
}

}  // namespace

int main(int argc, char** argv) {
  const bool listing = argc > 3 && std::strcmp(argv[1], "--list") == 0;
  if (!listing && argc < 6) return 118;
  for (const int number : {SIGINT, SIGTERM})
    std::signal(number, [](int signal) { ::kill(program, signal); });
  Tracer tracer;
  if (!listing) {
    tracer.wanted = {argv[1], argv[2]};
    tracer.number = std::strtoull(argv[3], nullptr, 10);
    tracer.error = std::atoi(argv[4]);  // NOLINT(cert-err34-c)
  }
  start(argv + (listing ? 3 : 5));
  const int status = tracer.follow();
  if (!listing) return tracer.happened() ? status : 119;
  std::ofstream out{argv[2]};
  for (const auto& [call, count] : tracer.counts()) {
    out << call.first << '\t' << call.second << '\t' << count << '\t';
    for (const int error : Tracer::kind_of(call.first).errors) out << error << ' ';
    out << '\n';
  }
  return status;
}
