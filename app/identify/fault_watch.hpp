// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <memory>
#include <span>

#include "app/config/config.hpp"
#include "app/identify/truck_result.hpp"
#include "dampline/damping/estimator.hpp"
#include "dampline/estimate/statistics.hpp"
#include "dampline/guard/guard.hpp"
#include "dampline/guard/judgement_delay.hpp"
#include "dampline/damping/estimator.hpp"

namespace dampline::app {

/// The faults at one moment, in the core's own time. Plain: it is handed between threads.
struct FaultView {
  std::array<Fault, FaultLog::kMost> faults{};
  std::size_t count{0};
  GuardInputs inputs;
  JudgementDelay::Counts held;
};

/// Names, sizes and times in the record's own time; no spans.
void describe_faults(const FaultView& view, const TruckRecord& record, double nominal_hz,
                     DataFaults& out);

/// The guards before an identification. take() does not allocate.
class FaultWatch {
 public:
  /// Precondition: Estimator::check(core).ok(). Throws UsageError naming the key that the guards
  /// cannot use.
  FaultWatch(const Config& config, const EstimatorConfig& core);
  /// True when it wrote the sample whose turn it is: an earlier one, replaced or marked as spoilt
  /// where the guards want that.
  bool take(const Sample& sample, Sample& out) noexcept {
    guard_->update(sample);
    return delay_->push(sample, *guard_, out);
  }
  /// No more samples: the guards judge what they have.
  void close() noexcept { guard_->finish(); }
  /// After close(): what still waits, one per call.
  [[nodiscard]] bool drain(Sample& out) noexcept { return delay_->drain(*guard_, out); }
  /// How long samples wait.
  [[nodiscard]] double wait_s() const noexcept { return wait_s_; }
  /// What is known now.
  [[nodiscard]] FaultView view() const noexcept;
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
  double wait_s_;
  std::unique_ptr<Guard> guard_;
  std::unique_ptr<JudgementDelay> delay_;
};

}  // namespace dampline::app
