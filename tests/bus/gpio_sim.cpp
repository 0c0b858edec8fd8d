// SPDX-License-Identifier: MIT
#include "tests/bus/gpio_sim.hpp"

#include <unistd.h>

#include <chrono>
#include <fstream>
#include <stdexcept>
#include <thread>

namespace dampline::bus {
namespace {

void write_to(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file{path};
  file << text;
  if (!file.flush()) throw std::runtime_error(path.string() + ": cannot be written");
}

std::string line_of(const std::filesystem::path& path) {
  std::ifstream file{path};
  std::string line;
  if (!std::getline(file, line)) throw std::runtime_error(path.string() + ": cannot be read");
  return line;
}

}  // namespace

GpioSim::GpioSim(unsigned lines)
    : config_{"/sys/kernel/config/gpio-sim/dampline" + std::to_string(::getpid())} {
  std::filesystem::create_directories(config_ / "bank");
  write_to(config_ / "bank" / "num_lines", std::to_string(lines));
  write_to(config_ / "live", "1");
  chip_ = line_of(config_ / "bank" / "chip_name");
  device_ = std::filesystem::path{"/sys/devices/platform"} / line_of(config_ / "dev_name") / chip_;
}

GpioSim::~GpioSim() {
  try {
    if (!chip_.empty()) remove();
  } catch (const std::exception&) {  // nothing is left to do
  }
  std::error_code ignored;
  std::filesystem::remove(config_ / "bank", ignored);
  std::filesystem::remove(config_, ignored);
}

std::filesystem::path GpioSim::pin(unsigned line) const {
  return device_ / ("sim_gpio" + std::to_string(line));
}

void GpioSim::pull(unsigned line, bool up) const {
  write_to(pin(line) / "pull", up ? "pull-up" : "pull-down");
}

void GpioSim::move(unsigned line, bool up) const {
  pull(line, up);
  // gpio-sim raises its interrupts from the next tick, which is every 10 ms in User-Mode Linux.
  std::this_thread::sleep_for(std::chrono::milliseconds{12});
}

bool GpioSim::high(unsigned line) const { return line_of(pin(line) / "value") == "1"; }

void GpioSim::remove() {
  write_to(config_ / "live", "0");
  chip_.clear();
}

}  // namespace dampline::bus
