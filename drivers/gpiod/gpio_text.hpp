// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <string>

#include "drivers/gpiod/gpiod.hpp"

namespace dampline::drivers {

/// "gpiochip0" is short for "/dev/gpiochip0".
[[nodiscard]] std::string chip_path(const std::string& chip);
/// What no library needs to be asked for.
[[nodiscard]] std::optional<Failure> check_lines(const EdgeConfig& config);
/// The chip could not be opened; `error` is errno.
[[nodiscard]] Failure chip_failure(const std::string& chip, int error);
/// A line of it could not be had.
[[nodiscard]] Failure line_failure(const std::string& chip, unsigned offset, int error);
[[nodiscard]] Errc gpio_error(int error) noexcept;

}  // namespace dampline::drivers
