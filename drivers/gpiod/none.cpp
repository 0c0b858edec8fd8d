// SPDX-License-Identifier: MIT
// The build found no libgpiod.
#include "drivers/gpiod/edges.hpp"

namespace dampline::drivers {
namespace {

Failure absent(const std::string& chip) {
  return {Errc::kIo, chip_path(chip) +
                         ": this program was built without libgpiod, expected a build with it "
                         "(Debian: libgpiod-dev and pkg-config)"};
}

}  // namespace

Outcome<std::unique_ptr<hal::EdgeSource>> open_edges(const EdgeConfig& config) {
  if (std::optional<Failure> failure = check_lines(config)) return *failure;
  return absent(config.chip);
}

Outcome<std::unique_ptr<hal::DigitalOutput>> open_output(const OutputConfig& config) {
  return absent(config.chip);
}

std::string gpio_library() { return "no libgpiod"; }

}  // namespace dampline::drivers
