// SPDX-License-Identifier: MIT
#include "app/verbs/simulate_files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

#include "sim_hw/writers.hpp"

namespace dampline::app {

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
