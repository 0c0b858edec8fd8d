// SPDX-License-Identifier: MIT
#include "tests/bus/child.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>
#include <thread>

namespace dampline::bus {
namespace {

int status_of(int raw) { return WIFEXITED(raw) ? WEXITSTATUS(raw) : 128 + WTERMSIG(raw); }

std::string unique(const std::string& stem) {
  static std::atomic<int> count{0};
  return stem + "." + std::to_string(::getpid()) + "." + std::to_string(count++);
}

}  // namespace

std::string read_file(const std::filesystem::path& path) {
  std::ifstream stream{path, std::ios::binary};
  return {std::istreambuf_iterator<char>{stream}, {}};
}

std::string run(const std::vector<std::string>& command) {
  const Folder folder;
  const Ended result = Child{command, folder.path()}.wait();
  if (result.status == 0) return result.output;
  std::string text;
  for (const std::string& word : command) text += word + " ";
  throw std::runtime_error{text + "ended with " + std::to_string(result.status) + ": " +
                           result.output + result.error};
}

Child::Child(const std::vector<std::string>& command, const std::filesystem::path& folder)
    : output_{folder / unique("stdout")}, error_{folder / unique("stderr")} {
  posix_spawn_file_actions_t actions{};
  ::posix_spawn_file_actions_init(&actions);
  constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC;
  ::posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, 1, output_.c_str(), kFlags, 0644);
  ::posix_spawn_file_actions_addopen(&actions, 2, error_.c_str(), kFlags, 0644);
  std::vector<char*> words;
  for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  const int error = ::posix_spawnp(&pid_, words[0], &actions, nullptr, words.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw std::system_error{error, std::generic_category(), command[0]};
}

Child::~Child() {
  if (ended_) return;
  signal(SIGKILL);
  ::waitpid(pid_, nullptr, 0);
}

void Child::signal(int number) const noexcept {
  if (!ended_) ::kill(pid_, number);
}

bool Child::running() noexcept {
  if (ended_) return false;
  int raw = 0;
  if (::waitpid(pid_, &raw, WNOHANG) != pid_) return true;
  status_ = status_of(raw);
  ended_ = true;
  return false;
}

Ended Child::wait(std::chrono::nanoseconds limit) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (running()) {
    if (std::chrono::steady_clock::now() > deadline) signal(SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds{20});
  }
  return {status_, output(), error()};
}

std::string Child::output() const { return read_file(output_); }
std::string Child::error() const { return read_file(error_); }

Folder::Folder() {
  // In memory where the machine has such a place, so that no test depends on a disk.
  const char* const given = std::getenv("TEST_TMPDIR");
  const std::filesystem::path base =
      given != nullptr ? given : std::filesystem::temp_directory_path();
  path_ = base / unique("dampline_bus");
  std::filesystem::remove_all(path_);
  std::filesystem::create_directories(path_);
}

Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace dampline::bus
