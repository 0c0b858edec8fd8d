// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <memory>
#include <span>

#include "app/identify/truck_result.hpp"
#include "dampline/estimate/statistics.hpp"
#include "dampline/guard/guard.hpp"
#include "dampline/identifier.hpp"

namespace dampline::app {

/// The guards beside an identification. take() does not allocate.
class FaultWatch {
 public:
  /// Precondition: Identifier::check(config).ok().
  explicit FaultWatch(const IdentifierConfig& config);
  void take(const Sample& sample) noexcept { guard_->update(sample); }
  [[nodiscard]] std::span<const Fault> found() const noexcept { return guard_->faults(); }
  /// White noise of each channel, rms; 0: not known yet.
  [[nodiscard]] std::array<double, kChannels> noise_mps2() const noexcept {
    std::array<double, kChannels> out{};
    for (std::size_t c = 0; c < kChannels; ++c) out[c] = guard_->noise_mps2(c);
    return out;
  }
  /// End of the record: faults, inputs, and, from the statistics, a parameter that changed; to the
  /// result, with a warning for the reader where there is any of them.
  void finish(const TruckRecord& record, const Statistics& statistics, RunResult& result);

 private:
  double nominal_hz_;
  std::unique_ptr<Guard> guard_;
};

}  // namespace dampline::app
