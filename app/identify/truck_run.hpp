// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/identify/collected.hpp"
#include "app/identify/truck_result.hpp"
#include "app/record/feed.hpp"
#include "app/record/rate.hpp"
#include "app/run/result.hpp"
#include "dampline/effect/judgement.hpp"
#include "dampline/identifier.hpp"

namespace dampline::app {

/// The estimator's settings from a configuration. Throws UsageError naming the key that a truck
/// record cannot use.
[[nodiscard]] EstimatorConfig estimator_config(const Config& config);

/// What is known at one moment of a run, in the core's own time. Plain: it is handed between
/// threads.
struct TruckView {
  Snapshot snapshot;
  std::int64_t first_tick{0};
  std::int64_t newest_tick{0};
  std::int64_t first_time_ns{0};
  std::int64_t newest_time_ns{0};
  FaultView faults;
  AlarmView alarms;
  double wheelset_mps2{0.0};       ///< rms, 4 to 90 Hz, of the newest block of spectra
  std::uint64_t usable_blocks{0};  ///< what an estimate is made of
};

/// A view as a result, in the record's own time. Throws RunError naming `source` when the measured
/// rate is not the nominal one. Precondition: view.snapshot.valid.
[[nodiscard]] RunResult describe_view(const TruckView& view, const MeasuredRate& rate,
                                      const Config& config, const std::string& source);

/// What tells a wrong unit of the accelerations.
[[nodiscard]] Magnitudes magnitudes_of(const TruckView& view, const Config& config);

/// The faults of a view, in seconds from its beginning by the nominal rate.
[[nodiscard]] DataFaults faults_of(const TruckView& view, double nominal_hz);

/// One truck record through the core's corridor; observes it, and keeps what a report shows beside
/// the result. Memory does not grow with the record; take() and view() do not allocate.
template <Parts kParts>
class TruckRun {
 public:
  using Core = BasicIdentifier<kParts>;

  /// `grids`: of the effects, where the run has them.
  explicit TruckRun(const Config& config, const RecordSignals& signals = {},
                    const effect::Grids& grids = {});
  void take(const CanFrame& frame) {
    Observer observer{*this};
    core_->push(frame, observer);
  }
  void take(const Sample& sample) {
    Observer observer{*this};
    core_->push(sample, observer);
  }
  /// No more frames: what is complete is taken.
  void flush() {
    Observer observer{*this};
    core_->flush(observer);
  }
  /// Sees every sample that was judged, with what the core made of it.
  using Watcher = std::function<void(const Sample&, const UpdateResult&)>;
  void watch(Watcher watcher) { watchers_.push_back(std::move(watcher)); }
  [[nodiscard]] bool empty() const noexcept { return samples_ == 0; }
  /// Samples so far, before they are judged.
  [[nodiscard]] std::uint64_t samples() const noexcept { return samples_; }
  /// Without ending the run.
  [[nodiscard]] TruckView view() noexcept;
  [[nodiscard]] std::int64_t first_tick() const noexcept { return first_tick_; }
  /// When the first and the newest sample were taken, by their own time. Precondition: not empty().
  [[nodiscard]] std::int64_t first_time_ns() const noexcept { return first_time_ns_; }
  [[nodiscard]] std::int64_t newest_time_ns() const noexcept { return newest_time_ns_; }
  [[nodiscard]] const IdentifierConfig& config() const noexcept { return core_->config(); }
  [[nodiscard]] const Core& core() const noexcept { return *core_; }
  [[nodiscard]] Core& core() noexcept { return *core_; }
  /// No more samples: the core gets what still waits for the guards. Done once.
  void close();
  /// close(), and what the record says. Precondition: not empty(). Throws RunError naming `source`
  /// when nothing could be identified, with the reasons, or when the measured rate is not the
  /// nominal one.
  [[nodiscard]] RunResult finish(const MeasuredRate& rate, const std::string& source);
  /// After finish(): what an explanation must know beside the sums.
  [[nodiscard]] const effect::Circumstances& circumstances() const noexcept {
    return circumstances_;
  }
  /// The newest sample, in seconds from the first; by the nominal rate.
  [[nodiscard]] double time_s() const noexcept;
  /// What the estimate rests on so far.
  [[nodiscard]] double used_s() const noexcept {
    return Estimator::kBlockS * static_cast<double>(used_blocks());
  }
  /// What became of the frames.
  [[nodiscard]] FrameSummary frames() const noexcept {
    return {core_->assembler().counts(), first_time_ns_};
  }
  /// For the progress line: level and stiffness as the history has them last.
  [[nodiscard]] std::string state_text() const;
  /// The sufficient statistics, for state.dls. Call after finish().
  [[nodiscard]] std::unique_ptr<Statistics> statistics();

 private:
  static constexpr std::size_t kStatuses = 8;
  struct Observer {
    TruckRun& run;
    void taken(const Sample& sample) noexcept { run.note_taken(sample); }
    void judged(const Sample& sample, const UpdateResult& result) { run.note(sample, result); }
  };

  [[nodiscard]] std::uint64_t used_blocks() const noexcept {
    return blocks_[static_cast<std::size_t>(BlockStatus::kUsed)] +
           blocks_[static_cast<std::size_t>(BlockStatus::kPartial)];
  }
  void note_taken(const Sample& sample) noexcept;
  void note(const Sample& sample, const UpdateResult& result);
  void note_block(const BlockReport& block);
  [[noreturn]] void fail_unusable(const Snapshot& snapshot, const std::string& source) const;

  Config config_;
  double rate_hz_;
  std::unique_ptr<Core> core_;
  double block_ticks_;
  bool closed_{false};
  std::uint64_t samples_{0};
  std::int64_t first_tick_{0};
  std::int64_t first_time_ns_{0};
  std::int64_t newest_tick_{0};
  std::int64_t newest_time_ns_{0};
  std::array<std::uint64_t, kStatuses> blocks_{};
  ConvergenceHistory history_;
  MotionExcerpt excerpt_;
  ExcludedList excluded_;
  ClippingWatch clipping_;
  effect::Circumstances circumstances_;
  std::vector<Watcher> watchers_;
};

extern template class TruckRun<kIdentifyParts>;
extern template class TruckRun<kExplainParts>;

/// With the sums that an explanation needs.
using ExplainRun = TruckRun<kExplainParts>;

}  // namespace dampline::app
