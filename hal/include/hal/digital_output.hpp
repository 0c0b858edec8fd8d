// SPDX-License-Identifier: MIT
#pragma once
#include "dampline/result.hpp"

namespace dampline::hal {

/// One digital output, say a status lamp. `active` is logical: polarity is the driver's matter.
class DigitalOutput {
 public:
  DigitalOutput() = default;
  DigitalOutput(const DigitalOutput&) = delete;
  DigitalOutput& operator=(const DigitalOutput&) = delete;
  virtual ~DigitalOutput() = default;
  /// The state now set, or kIo / kLinkDown.
  [[nodiscard]] Result<bool> set(bool active) noexcept { return do_set(active); }

 private:
  virtual Result<bool> do_set(bool active) noexcept = 0;
};

}  // namespace dampline::hal
