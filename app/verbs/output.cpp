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
#include "app/text/format.hpp"
#include "sim_hw/writers.hpp"

namespace dampline::app {

TextFile::TextFile(std::string path, bool replace) : path_(std::move(path)), replace_(replace) {
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
  direct ? open_there() : open_beside();
  if (file_ < 0) fail("cannot be opened for writing");
}

void TextFile::open_there() { file_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC); }

/// Whoever exchanges the folder meanwhile moves no file of ours.
void TextFile::open_beside() {
  constexpr int kMode = 0666;
  const std::filesystem::path parent = std::filesystem::path{path_}.parent_path();
  folder_ =
      Descriptor{::open(parent.empty() ? "." : parent.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC)};
  if (folder_.get() < 0) return;
  const std::string name = partial_name();
  file_ = ::openat(folder_.get(), name.c_str(),
                   O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, kMode);
  if (file_ >= 0) staged_ = name;
}

TextFile::~TextFile() {
  if (file_ >= 0 && !is_stdout()) ::close(file_);
  if (!staged_.empty()) ::unlinkat(folder_.get(), staged_.c_str(), 0);
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

void TextFile::finish() {
  flush();
  const int file = std::exchange(file_, -1);
  if (is_stdout()) return;
  const bool synced = staged_.empty() || !replace_ || ::fsync(file) == 0;
  if (::close(file) != 0 || !synced) fail("cannot be written");
}

void TextFile::appear() {
  if (staged_.empty()) return;
  const unsigned how = replace_ ? 0 : RENAME_NOREPLACE;
  const int folder = folder_.get();
  const std::string name = std::filesystem::path{path_}.filename().string();
  int moved = ::renameat2(folder, staged_.c_str(), folder, name.c_str(), how);
  if (moved != 0 && (errno == EINVAL || errno == ENOSYS))  // a file system without that choice
    moved = ::renameat(folder, staged_.c_str(), folder, name.c_str());
  if (moved != 0) fail("cannot be written");
  staged_.clear();
  is_new_ = !replace_;
}

void TextFile::withdraw() const noexcept {
  const std::string name = std::filesystem::path{path_}.filename().string();
  if (is_new_) ::unlinkat(folder_.get(), name.c_str(), 0);
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
  if (shown_ && sample % step_ == 0) tell(fmt::format("\rsimulate: {} %", sample / step_));
}

void SimulateProgress::end() const {
  if (shown_) tell("\r");
}

}  // namespace dampline::app
