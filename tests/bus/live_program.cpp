// SPDX-License-Identifier: MIT
#include "tests/bus/live_program.hpp"

#include <csignal>
#include <stdexcept>
#include <thread>

namespace dampline::bus {
namespace {

const std::string kDampline = DAMPLINE_BINARY_DIR "/dampline";

Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

}  // namespace

nlohmann::json read_parameters(const std::filesystem::path& run) {
  return nlohmann::json::parse(read_file(run / "parameters.json"));
}

RunFiles read_run(const std::filesystem::path& run) {
  const nlohmann::json all = read_parameters(run);
  return {all.at("parameters").dump(1), all.at("counts").dump(1), read_file(run / "state.dls"),
          read_file(run / "curve.csv"), read_file(run / "convergence.csv")};
}

double value_of(const nlohmann::json& parameters, const std::string& name) {
  for (const auto& parameter : parameters.at("parameters"))
    if (parameter.at("name") == name) return parameter.at("value").get<double>();
  throw std::runtime_error{"no parameter " + name};
}

LiveProgram::LiveProgram(const Folder& folder, const std::string& interface,
                         std::filesystem::path run, const Words& options)
    : run_{std::move(run)},
      child_{Words{kDampline, "identify", interface, "--out", run_, "--no-report"} + options,
             folder.path()} {
  std::this_thread::sleep_for(std::chrono::seconds{1});
  if (!child_.running()) throw std::runtime_error{"ended at once: " + child_.error()};
}

std::uint64_t LiveProgram::memory_kib(const std::string& name) {
  if (!child_.running()) {
    const Ended ended = child_.wait();
    throw std::runtime_error{"ended with " + std::to_string(ended.status) + ": " + ended.error};
  }
  const std::string status = read_file("/proc/" + std::to_string(child_.pid()) + "/status");
  const std::size_t at = status.find(name + ":");
  if (at == std::string::npos) throw std::runtime_error{"no " + name};
  return std::stoull(status.substr(at + name.size() + 1));
}

nlohmann::json LiveProgram::stop() {
  child_.signal(SIGINT);
  const Ended ended = child_.wait(std::chrono::minutes{1});
  if (ended.status != 0)
    throw std::runtime_error{"status " + std::to_string(ended.status) + ": " + ended.error};
  return read_parameters(run_);
}

void identify(const std::filesystem::path& record, const std::filesystem::path& run_folder) {
  run({kDampline, "identify", record, "--out", run_folder, "--no-report", "--quiet"});
}

Words simulate_command(const std::string& interface, double duration_s, int batch,
                       const Words& options) {
  return Words{"chrt",
               "--fifo",
               "60",
               kDampline,
               "simulate",
               "--to",
               interface,
               "--duration",
               std::to_string(duration_s),
               "--batch",
               std::to_string(batch),
               "--quiet"} +
         options;
}

}  // namespace dampline::bus
