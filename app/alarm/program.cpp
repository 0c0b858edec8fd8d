// SPDX-License-Identifier: MIT
#include "app/alarm/program.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <utility>

#include "app/error.hpp"

namespace dampline::app {
namespace {

std::string number_text(const std::optional<double>& value) {
  return value ? fmt::format("{:.6g}", *value) : "-";
}

/// No signal is blocked in it, and each does what it does by itself.
class SpawnAttributes {
 public:
  SpawnAttributes() noexcept {
    ::posix_spawnattr_init(&attributes_);
    sigset_t signals;
    ::sigemptyset(&signals);
    ::posix_spawnattr_setsigmask(&attributes_, &signals);
    for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) ::sigaddset(&signals, number);
    ::posix_spawnattr_setsigdefault(&attributes_, &signals);
    ::posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  }
  SpawnAttributes(const SpawnAttributes&) = delete;
  SpawnAttributes& operator=(const SpawnAttributes&) = delete;
  ~SpawnAttributes() { ::posix_spawnattr_destroy(&attributes_); }
  [[nodiscard]] const posix_spawnattr_t* get() const noexcept { return &attributes_; }

 private:
  posix_spawnattr_t attributes_{};
};

}  // namespace

AlarmProgram::AlarmProgram(std::vector<std::string> command) : command_{std::move(command)} {
  if (command_.empty()) return;
  const std::string& path = command_.front();
  if (path.empty() || path.front() != '/' || ::access(path.c_str(), X_OK) != 0)
    throw UsageError{fmt::format(
        "[alarm] on_alarm: found \"{}\", expected the absolute path of a program that can be run",
        path)};
}

bool AlarmProgram::start(const AlarmChange& change, double now_s) {
  if (command_.empty()) return true;
  std::vector<std::string> words = command_;
  const WatchState& watch = change.watch;
  for (std::string word :
       {watch.name, std::string{watch.active ? "raised" : "cleared"}, number_text(watch.value),
        number_text(watch.limit), watch.unit.empty() ? std::string{"-"} : watch.unit,
        fmt::format("{:.1f}", now_s)})
    words.push_back(std::move(word));
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const SpawnAttributes attributes;
  pid_t child = 0;
  const bool started = running_.size() < kMostRunning &&
                       ::posix_spawn(&child, command_.front().c_str(), nullptr, attributes.get(),
                                     arguments.data(), environ) == 0;
  if (started) running_.push_back(child);
  if (!started) ++failures_;
  return started;
}

void AlarmProgram::collect() noexcept {
  std::erase_if(running_, [](pid_t child) { return ::waitpid(child, nullptr, WNOHANG) != 0; });
}

}  // namespace dampline::app
