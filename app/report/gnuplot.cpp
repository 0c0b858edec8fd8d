// SPDX-License-Identifier: MIT
#include "app/report/gnuplot.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "app/error.hpp"

namespace dampline::app {
namespace {

struct CloseFile {
  // NOLINTNEXTLINE(cppcoreguidelines-owning-memory) the owner is the unique_ptr that calls this
  void operator()(std::FILE* file) const { std::fclose(file); }
};
/// Unnamed files instead of pipes: no side ever waits for the other.
using TemporaryFile = std::unique_ptr<std::FILE, CloseFile>;

TemporaryFile make_temporary(const std::string& content) {
  TemporaryFile file{std::tmpfile()};
  if (!file || std::fwrite(content.data(), 1, content.size(), file.get()) != content.size() ||
      std::fflush(file.get()) != 0)
    throw RunError{fmt::format("no temporary file: {}", std::strerror(errno))};
  std::rewind(file.get());
  return file;
}

std::string read_back(const TemporaryFile& file) {
  std::rewind(file.get());
  std::string text;
  std::array<char, 65536> buffer{};
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), file.get()))
    text.append(buffer.data(), count);
  return text;
}

int wait_for(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

ChildResult run_child(const std::vector<std::string>& command, const std::string& input) {
  const std::array<TemporaryFile, 3> files{make_temporary(input), make_temporary(""),
                                           make_temporary("")};
  std::vector<std::string> words = command;
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (int i = 0; i < 3; ++i)
    posix_spawn_file_actions_adddup2(&actions, ::fileno(files[static_cast<std::size_t>(i)].get()),
                                     i);
  pid_t child = 0;
  const int failure =
      ::posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), ::environ);
  posix_spawn_file_actions_destroy(&actions);
  ChildResult result;
  if (failure == ENOENT || failure == EACCES) return result;
  if (failure != 0)
    throw RunError{fmt::format("{}: cannot start: {}", command[0], std::strerror(failure))};
  result.started = true;
  result.status = wait_for(child);
  result.output = read_back(files[1]);
  result.error = read_back(files[2]);
  return result;
}

Drawing draw(const PlotScript& plot, const std::string& name) {
  const std::string terminal = fmt::format(
      "set terminal svg size {},{} dynamic name '{}' font 'Helvetica,Arial,DejaVu "
      "Sans,sans-serif,14' "
      "fontscale 0.95 background '#ffffff'\n",
      plot.width, plot.height, name);
  const ChildResult result = run_child({"gnuplot", "-"}, terminal + plot.script);
  if (!result.started) return {"", "gnuplot was not found; install gnuplot-nox for the plots"};
  const std::size_t begin = result.output.find("<svg");
  const std::size_t end = result.output.rfind("</svg>");
  if (result.status != 0 || begin == std::string::npos || end == std::string::npos)
    return {"", fmt::format("gnuplot failed (exit {}): {}", result.status,
                            result.error.substr(0, 400))};
  return {result.output.substr(begin, end + 6 - begin), ""};
}

}  // namespace dampline::app
