// SPDX-License-Identifier: MIT
// The whole program, killed before each system call that changes a file, and with each of these
// failing: the earlier run or the new one is there, whole, and nothing else stays.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/app/program.hpp"

namespace dampline::app {
namespace {

#if defined(__x86_64__) && !defined(DAMPLINE_SANITIZED)

namespace fs = std::filesystem;

/// Calls by which files and directories change.
bool changes_files(const user_regs_struct& regs) {
  constexpr std::array kCalls{SYS_mkdir,    SYS_mkdirat, SYS_write,     SYS_fsync,    SYS_rename,
                              SYS_renameat, SYS_unlink,  SYS_renameat2, SYS_unlinkat, SYS_rmdir,
                              SYS_link,     SYS_linkat,  SYS_chmod,     SYS_fchmodat};
  if (regs.orig_rax == SYS_openat) return (regs.rdx & O_CREAT) != 0;
  return std::find(kCalls.begin(), kCalls.end(), static_cast<long>(regs.orig_rax)) != kCalls.end();
}

struct Interruption {
  int at{0};       ///< which of the calls that change files; 0: none
  int error{0};    ///< the call fails with it; 0: the program is killed before it
  int calls{0};    ///< out: how many there were
  int status{-1};  ///< out: exit code, 128 + signal
};

/// Runs a command in `folder` under ptrace.
void run_traced(const std::vector<std::string>& command, const fs::path& folder,
                Interruption& how) {
  const pid_t child = ::fork();
  if (child == 0) {
    std::vector<char*> words;
    for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    const int quiet = ::open("/dev/null", O_WRONLY);
    ::dup2(quiet, 1);
    ::dup2(quiet, 2);
    if (::chdir(folder.c_str()) != 0 || ::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0)
      ::_exit(120);
    ::execv(words[0], words.data());
    ::_exit(121);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ::ptrace(PTRACE_SETOPTIONS, child, nullptr, PTRACE_O_TRACESYSGOOD | PTRACE_O_EXITKILL);
  bool entering = false;
  bool failing = false;
  for (;;) {
    ::ptrace(PTRACE_SYSCALL, child, nullptr, nullptr);
    ::waitpid(child, &status, 0);
    if (!WIFSTOPPED(status)) break;
    if (WSTOPSIG(status) != (SIGTRAP | 0x80)) continue;
    entering = !entering;
    user_regs_struct regs{};
    ::ptrace(PTRACE_GETREGS, child, nullptr, &regs);
    if (entering && changes_files(regs) && ++how.calls == how.at) {
      if (how.error == 0) ::kill(child, SIGKILL);
      regs.orig_rax = ~0ULL;  // no such call
      failing = how.error != 0;
      ::ptrace(PTRACE_SETREGS, child, nullptr, &regs);
    } else if (!entering && failing) {
      failing = false;
      regs.rax = static_cast<unsigned long long>(-static_cast<long long>(how.error));
      ::ptrace(PTRACE_SETREGS, child, nullptr, &regs);
    }
  }
  how.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

using Files = std::map<std::string, std::string>;

Files files_of(const Program& program, const std::string& folder) {
  Files files;
  if (!program.exists(folder)) return files;
  for (const auto& entry : fs::recursive_directory_iterator{program.path(folder)})
    if (entry.is_regular_file())
      files[fs::relative(entry.path(), program.path(folder))] =
          program.read(fs::relative(entry.path(), program.path(".")));
  return files;
}

std::set<std::string> names_in(const Program& program) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator{program.path(".")})
    if (const std::string name = entry.path().filename(); name != ".stdout" && name != ".stderr")
      names.insert(name);
  return names;
}

class Interrupted : public testing::Test {
 protected:
  Interrupted() {
    EXPECT_EQ(program_.run("simulate --duration 20 --seed 1 --quiet --out old.csv").code, 0);
    EXPECT_EQ(program_.run("simulate --duration 20 --seed 2 --quiet --out new.csv").code, 0);
    EXPECT_EQ(program_.run("identify old.csv --out run --quiet").code, 0);
    fs::create_directories(program_.path("run/blackbox"));
    program_.write("run/blackbox/kept", "frames");
    old_ = files_of(program_, "run");
    fs::copy(program_.path("run"), program_.path("spare"), fs::copy_options::recursive);
    command_ = {DAMPLINE_BINARY_DIR "/dampline",
                "identify",
                "new.csv",
                "--out",
                "run",
                "--quiet",
                "--force"};
    Interruption none;
    run_traced(command_, program_.path("."), none);
    EXPECT_EQ(none.status, 0);
    calls_ = none.calls;
    new_ = files_of(program_, "run");
    EXPECT_EQ(new_["blackbox/kept"], "frames");
    EXPECT_NE(new_["state.dls"], old_["state.dls"]);
  }
  void restore() {
    fs::remove_all(program_.path("run"));
    fs::copy(program_.path("spare"), program_.path("run"), fs::copy_options::recursive);
  }
  /// Which of the two it is; anything else fails the test.
  bool is_new(int call) {
    const Files found = files_of(program_, "run");
    EXPECT_TRUE(found == old_ || found == new_) << "at call " << call << " of " << calls_;
    return found == new_;
  }

  const Program program_;
  std::vector<std::string> command_;
  Files old_;
  Files new_;
  int calls_{0};
};

TEST_F(Interrupted, AKillLeavesTheEarlierRunOrTheNewOne) {
  ASSERT_GT(calls_, 40);
  for (int call = 1; call <= calls_; ++call) {
    restore();
    Interruption how{.at = call};
    run_traced(command_, program_.path("."), how);
    ASSERT_EQ(how.status, 128 + SIGKILL);
    is_new(call);
  }
  restore();
  ASSERT_EQ(program_.run("identify new.csv --out run --quiet --force").code, 0);
  EXPECT_TRUE(is_new(0));
  EXPECT_EQ(names_in(program_), (std::set<std::string>{"new.csv", "old.csv", "run", "spare"}))
      << "the next run removes what killed ones left";
}

using InterruptedNightly = Interrupted;

TEST_F(InterruptedNightly, AnErrorLeavesTheEarlierRunOrTheNewOneAndNothingElse) {
  for (const int error : {EIO, ENOSPC}) {
    for (int call = 1; call <= calls_; ++call) {
      restore();
      Interruption how{.at = call, .error = error};
      run_traced(command_, program_.path("."), how);
      if (how.status == 0) {
        EXPECT_TRUE(is_new(call)) << "a success that is none";
      } else {
        EXPECT_EQ(how.status, 1) << call;
        is_new(call);
      }
      const auto names = names_in(program_);
      EXPECT_LE(names.size(), 5U) << "what could not be removed, at most";
    }
  }
}

#endif

}  // namespace
}  // namespace dampline::app
