// SPDX-License-Identifier: MIT
#pragma once
#include <filesystem>
#include <string>

namespace dampline::bus {

/// A simulated GPIO chip of the test's own, by the kernel's gpio-sim; goes away with it.
class GpioSim {
 public:
  /// Throws std::runtime_error where the kernel does not give one.
  explicit GpioSim(unsigned lines = 8);
  GpioSim(const GpioSim&) = delete;
  GpioSim& operator=(const GpioSim&) = delete;
  ~GpioSim();
  /// "gpiochip0"
  [[nodiscard]] const std::string& chip() const noexcept { return chip_; }
  /// What is outside pulls the line up or down.
  void pull(unsigned line, bool up) const;
  /// The same, and time for the kernel to see it: edges closer together merge before any driver.
  void move(unsigned line, bool up) const;
  /// The voltage of a line, whoever drives it.
  [[nodiscard]] bool high(unsigned line) const;
  /// Unplugs the chip.
  void remove();

 private:
  [[nodiscard]] std::filesystem::path pin(unsigned line) const;
  std::filesystem::path config_;
  std::filesystem::path device_;
  std::string chip_;
};

}  // namespace dampline::bus
