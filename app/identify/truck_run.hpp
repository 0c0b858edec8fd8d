// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "app/config/config.hpp"
#include "app/identify/alarm_watch.hpp"
#include "app/identify/clipping_watch.hpp"
#include "app/identify/convergence_history.hpp"
#include "app/identify/excluded_list.hpp"
#include "app/identify/fault_watch.hpp"
#include "app/identify/motion_excerpt.hpp"
#include "app/identify/rate_correction.hpp"
#include "app/run/result.hpp"
#include "dampline/damping/estimator.hpp"
#include "dampline/methods.hpp"
#include "dampline/phase/view.hpp"

namespace dampline::app {

/// The core's settings from a configuration. Throws UsageError naming the key that a truck record
/// cannot use.
[[nodiscard]] EstimatorConfig identifier_config(const Config& config);

/// What is known at one moment of a run, in the core's own time. Plain: it is handed between
/// threads.
struct TruckView {
  Snapshot snapshot;
  std::int64_t first_tick{0};
  std::int64_t newest_tick{0};
  std::int64_t first_time_ns{0};
  FaultView faults;
  AlarmView alarms;
};

/// A view as a result, in the record's own time. Throws RunError naming `source` when the measured
/// rate is not the nominal one. Precondition: view.snapshot.valid.
[[nodiscard]] RunResult describe_view(const TruckView& view, const MeasuredRate& rate,
                                      const Config& config, const std::string& source);

/// The faults of a view, in seconds from its beginning by the nominal rate.
[[nodiscard]] DataFaults faults_of(const TruckView& view, double nominal_hz);

/// One truck record through the core: takes samples, keeps what a report shows beside the result.
/// Memory does not grow with the record; take() and view() do not allocate. The core sees a sample
/// when the guards have judged it, [guards] wait_s later.
class TruckRun {
 public:
  /// `screen`: what is known of the channels; its rate is the configuration's.
  explicit TruckRun(const Config& config, const ScreenConfig& screen = {});
  void take(const Sample& sample);
  /// Sees every sample with what the core made of it.
  using Watcher = std::function<void(const Sample&, const UpdateResult&)>;
  void watch(Watcher watcher) { watcher_ = std::move(watcher); }
  [[nodiscard]] bool empty() const noexcept { return !started_; }
  /// Without ending the run.
  [[nodiscard]] TruckView view() noexcept;
  /// When the first sample was taken, by its own time. Precondition: not empty().
  [[nodiscard]] std::int64_t first_time_ns() const noexcept { return first_time_ns_; }
  /// Faults of the data, so far.
  [[nodiscard]] std::span<const Fault> fault_kinds() const noexcept { return faults_.found(); }
  /// White noise of each channel, rms, what its resolution makes included; 0: not known yet.
  [[nodiscard]] std::array<double, kChannels> noise_mps2() const noexcept {
    return faults_.noise_mps2();
  }
  /// No more samples: the core gets what still waits for the guards. Done once.
  void close();
  /// close(), and what the record says. Precondition: not empty(). Throws RunError naming `source`
  /// when nothing could be identified, with the reasons, or when the measured rate is not the
  /// nominal one.
  [[nodiscard]] RunResult finish(const MeasuredRate& rate, const std::string& source);

  /// The newest sample, in seconds from the first; by the nominal rate.
  [[nodiscard]] double time_s() const noexcept;
  /// For the progress line: the newest row of the history, or null.
  [[nodiscard]] const ConvergenceHistory::Row* newest() const noexcept;
  /// The sufficient statistics as state.dls holds them. Call after finish().
  [[nodiscard]] std::string encoded_state();

 private:
  static constexpr std::size_t kStatuses = 8;

  void use(const Sample& sample);
  void note_block(const BlockReport& block);
  [[nodiscard]] std::uint64_t blocks(BlockStatus status) const noexcept {
    return blocks_[static_cast<std::size_t>(status)];
  }
  [[noreturn]] void fail_unusable(const Snapshot& snapshot, const std::string& source) const;

  EstimatorConfig core_;
  Config config_;
  std::unique_ptr<Estimator> identifier_;
  std::unique_ptr<Methods> methods_;
  std::unique_ptr<PhaseView> phase_;
  double block_ticks_;
  bool started_{false};
  bool closed_{false};
  std::int64_t first_tick_{0};
  std::int64_t first_time_ns_{0};
  std::int64_t newest_tick_{0};
  std::array<std::uint64_t, kStatuses> blocks_{};
  ConvergenceHistory history_;
  MotionExcerpt excerpt_;
  ExcludedList excluded_;
  ClippingWatch clipping_;
  FaultWatch faults_;
  AlarmWatch alarms_;
  Watcher watcher_;
};

}  // namespace dampline::app
