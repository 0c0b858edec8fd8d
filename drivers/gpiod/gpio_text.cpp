// SPDX-License-Identifier: MIT
#include "drivers/gpiod/gpio_text.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <system_error>

namespace dampline::drivers {
namespace {

constexpr std::size_t kMostLines = 64;  // of one chip at once, in both versions of the library

std::string reason(int error) { return std::generic_category().message(error); }

Failure wrong(const std::string& text) { return {Errc::kInvalidConfig, text}; }

const char* advice(int error) {
  if (error == EBUSY) return "somebody else has it, expected a free line; `gpioinfo` says who";
  if (error == EINVAL) return "expected a line that the chip has; `gpioinfo` lists them";
  if (error == ENXIO) return "expected a line that can raise interrupts";
  return "expected a line that can be requested";
}

}  // namespace

std::string chip_path(const std::string& chip) {
  return chip.starts_with('/') ? chip : "/dev/" + chip;
}

std::optional<Failure> check_lines(const EdgeConfig& config) {
  if (config.lines.empty()) return wrong("no GPIO line is named, expected at least one");
  if (config.lines.size() > kMostLines) {
    return wrong(fmt::format("{}: {} lines, expected at most {}", config.chip, config.lines.size(),
                             kMostLines));
  }
  for (std::size_t i = 0; i < config.lines.size(); ++i) {
    const EdgeLine& line = config.lines[i];
    if (!line.rising && !line.falling) {
      return wrong(fmt::format("{} line {}: no edge is watched, expected rising, falling or both",
                               config.chip, line.offset));
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (config.lines[j].offset != line.offset) continue;
      return wrong(fmt::format("{} line {}: named twice, expected once", config.chip, line.offset));
    }
  }
  return std::nullopt;
}

Failure chip_failure(const std::string& chip, int error) {
  return {gpio_error(error),
          fmt::format("{}: {}; expected a GPIO chip that may be opened (`gpiodetect` lists them)",
                      chip_path(chip), reason(error))};
}

Failure line_failure(const std::string& chip, unsigned offset, int error) {
  return {gpio_error(error),
          fmt::format("{} line {}: {}; {}", chip_path(chip), offset, reason(error), advice(error))};
}

Errc gpio_error(int error) noexcept { return error == ENODEV ? Errc::kLinkDown : Errc::kIo; }

}  // namespace dampline::drivers
