// SPDX-License-Identifier: MIT
#include "app/verbs/output.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>
#include <utility>

#include "app/error.hpp"
#include "sim_hw/writers.hpp"

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

TruthFile::TruthFile(const std::string& path, const sim::SimulationConfig& config) {
  if (path.empty()) return;
  file_.emplace(path);
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
