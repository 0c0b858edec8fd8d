// SPDX-License-Identifier: MIT
#include "app/verbs/output.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>  // renameat2()
#include <filesystem>
#include <system_error>
#include <utility>

#include "app/error.hpp"
#include "app/run/disk.hpp"
#include "sim_hw/writers.hpp"

namespace dampline::app {

TextFile::TextFile(std::string path, bool replace) : path_(std::move(path)), replace_(replace) {
  constexpr int kMode = 0666;
  if (is_stdout()) {
    file_ = STDOUT_FILENO;
    return;
  }
  std::error_code ignored;
  const std::filesystem::file_status there = std::filesystem::status(path_, ignored);
  // Devices, pipes and /dev/stdout are written to; a file is replaced, when it is whole.
  const bool direct = std::filesystem::exists(there) &&
                      (!std::filesystem::is_regular_file(there) || path_.starts_with("/dev/"));
  if (!direct && !replace_ && std::filesystem::exists(there))
    throw UsageError(fmt::format("{}: exists already; --force replaces it", path_));
  if (!direct) staged_ = (std::filesystem::path{path_}.parent_path() / partial_name()).string();
  file_ =
      direct ? ::open(path_.c_str(), O_WRONLY | O_CLOEXEC)
             : ::open(staged_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, kMode);
  if (file_ < 0) fail("cannot be opened for writing");
}

TextFile::~TextFile() {
  if (file_ >= 0 && !is_stdout()) ::close(file_);
  if (!staged_.empty()) ::unlink(staged_.c_str());
}

void TextFile::fail(const char* action) const {
  if (is_stdout() && errno == EPIPE) throw ClosedPipe{"standard output was closed"};
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
  if (is_stdout()) return;
  const bool synced = staged_.empty() || !replace_ || ::fsync(file) == 0;
  if (::close(file) != 0 || !synced) fail("cannot be written");
  if (staged_.empty()) return;
  const unsigned how = replace_ ? 0 : RENAME_NOREPLACE;
  int moved = ::renameat2(AT_FDCWD, staged_.c_str(), AT_FDCWD, path_.c_str(), how);
  if (moved != 0 && (errno == EINVAL || errno == ENOSYS))  // a file system without that choice
    moved = ::rename(staged_.c_str(), path_.c_str());
  if (moved != 0) fail("cannot be written");
  staged_.clear();
}

TruthFile::TruthFile(const std::string& path, const sim::SimulationConfig& config, bool replace) {
  if (path.empty()) return;
  file_.emplace(path, replace);
  const std::string head = sim::truth_header(config);
  file_->buffer().append(head.data(), head.data() + head.size());
}

void TruthFile::append(const sim::SimulatedSample& sample) {
  if (!file_) return;
  sim::append_truth(file_->buffer(), sample);
  file_->tick();
}

void TruthFile::close() {
  if (file_) file_->close();
}

SimulateProgress::SimulateProgress(std::int64_t samples, bool quiet)
    : step_(samples / 100 + 1), shown_(!quiet && isatty(STDERR_FILENO) != 0) {}

void SimulateProgress::at(std::int64_t sample) const {
  if (shown_ && sample % step_ == 0) fmt::print(stderr, "\rsimulate: {} %", sample / step_);
}

void SimulateProgress::end() const {
  if (shown_) fmt::print(stderr, "\r");
}

}  // namespace dampline::app
