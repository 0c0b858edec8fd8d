// SPDX-License-Identifier: MIT
#include "app/verbs/text_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include "app/error.hpp"

namespace dampline::app {

TextFile::TextFile(std::string path) : path_(std::move(path)) {
  constexpr int kMode = 0666;
  file_ = is_stdout() ? STDOUT_FILENO
                      : ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kMode);
  if (file_ < 0) fail("cannot be opened for writing");
}

TextFile::~TextFile() {
  if (file_ < 0 || is_stdout()) return;
  ::close(file_);
  // a device such as /dev/full is not ours to remove
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path_, ignored)) std::filesystem::remove(path_, ignored);
}

void TextFile::fail(const char* action) const {
  throw RunError(fmt::format("{}: {}: {}", is_stdout() ? "standard output" : path_, action,
                             std::generic_category().message(errno)));
}

void TextFile::flush() {
  std::size_t done = 0;
  while (done < buffer_.size()) {
    const auto written = ::write(file_, buffer_.data() + done, buffer_.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("cannot be written");
    done += static_cast<std::size_t>(written);
  }
  buffer_.clear();
}

void TextFile::close() {
  flush();
  const int file = std::exchange(file_, -1);
  if (!is_stdout() && ::close(file) != 0) fail("cannot be written");
}

}  // namespace dampline::app
