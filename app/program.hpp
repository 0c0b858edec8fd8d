// SPDX-License-Identifier: MIT
#pragma once
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <functional>
#include <new>
#include <string>
#include <system_error>

#include "app/error.hpp"
#include "app/text/format.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app {

/// Prints the error and returns the exit code. Further lines are indented, so that no text from
/// outside passes for a message of its own.
inline int fail(const char* text, int code) {
  std::string lines = drivers::printable(text, true);
  for (std::size_t at = 0; (at = lines.find('\n', at)) != std::string::npos; ++at)
    lines.insert(at + 1, "  ");
  tell(fmt::format("dampline: error: {}\n", lines));
  return code;
}

/// A full disk, say. The reason is lost where an earlier write found it.
inline std::string cannot_print() {
  const std::string text = "standard output cannot be written";
  return errno == 0 ? text : text + ": " + std::generic_category().message(errno);
}

/// As a program does that knows nothing of pipes, after everything was cleaned up: `... | head`.
inline int end_by_closed_pipe() {
  std::signal(SIGPIPE, SIG_DFL);
  return std::raise(SIGPIPE) == 0 ? 0 : 1;
}

/// The action's exit code: 0, or 1 where the run failed, 2 for a wrong usage.
inline int exit_code(const std::function<int()>& action) {
  constexpr int kRunFailed = 1;
  try {
    const int code = action();
    // A full disk behind standard output is a failed run, not a success.
    errno = 0;
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
      return errno == EPIPE ? end_by_closed_pipe() : fail(cannot_print().c_str(), kRunFailed);
    return code;
  } catch (const ClosedPipe&) {
    return end_by_closed_pipe();
  } catch (const std::system_error& error) {
    if (error.code() == std::errc::broken_pipe) return end_by_closed_pipe();
    if (error.code() == std::errc::resource_unavailable_try_again)
      return fail((std::string{"no further thread can be started: "} + error.what()).c_str(),
                  kRunFailed);
    return fail(error.what(), kRunFailed);
  } catch (const UsageError& error) {
    return fail(error.what(), 2);
  } catch (const std::bad_alloc&) {
    return fail("out of memory", kRunFailed);
  } catch (const std::exception& error) {
    return fail(error.what(), kRunFailed);
  }
}

/// What main() does: parses the command line, by which a verb sets `action`, and acts.
inline int run(CLI::App& program, const std::function<int()>& action, int argc, char** argv) {
  // Both are reported where the write fails, with the file's name.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : 2;
  }
  return exit_code(action);
}

}  // namespace dampline::app
