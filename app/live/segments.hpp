// SPDX-License-Identifier: MIT
#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "app/config/config.hpp"
#include "app/identify/truck_run.hpp"
#include "app/live/handover.hpp"
#include "app/run/provenance.hpp"
#include "app/run/state.hpp"
#include "dampline/damping/estimator.hpp"
#include "dampline/motion/reference_low_pass.hpp"

namespace dampline::app {

/// What is known of one segment so far. Plain: it is handed between threads; some 280 KiB.
struct SegmentState {
  Statistics sums;
  TruckView view;  ///< the segment's ticks and times, the run's faults; no snapshot
  MeasuredRate rate;
  std::uint64_t number{0};         ///< of the segment in its run
  bool is_last{false};             ///< of its segment
  std::int64_t run_first_tick{0};  ///< from which the times of faults count
};

/// The sums of a live run by segments of UTC, beside those of the whole: an estimator of its own
/// sees the same judged samples and begins new sums at each full hour, while its filters and open
/// blocks go on. So each block is in one segment and no motion is lost between two. Where time goes
/// back a segment begins, too. Memory is fixed; take() does not allocate.
class SegmentRun {
 public:
  /// Sees what `run` takes from now on; `run` outlives it.
  SegmentRun(const Config& config, ExplainRun& run);
  SegmentRun(const SegmentRun&) = delete;
  SegmentRun& operator=(const SegmentRun&) = delete;

  /// After the run is closed: the last segment's end.
  void finish();

  // For another thread:
  /// True: front() is another state, ended segments first, in their order. Of the segment that goes
  /// on only the newest is given, and none after its end.
  [[nodiscard]] bool next();
  [[nodiscard]] const SegmentState& front() const noexcept { return *front_; }
  /// Ended segments whose last state found no room: nobody called next() for hours.
  [[nodiscard]] std::uint64_t lost() const noexcept {
    return lost_.load(std::memory_order_acquire);
  }

 private:
  static constexpr std::size_t kEnded = 4;

  void take(const Sample& sample) noexcept;
  void begin(const Sample& sample) noexcept;
  void end() noexcept;
  void export_to(SegmentState& out) noexcept;

  ExplainRun& run_;
  ReferenceLowPass low_pass_;
  std::unique_ptr<Estimator> estimator_;
  std::int64_t segment_ns_;
  std::int64_t every_ns_;
  std::uint64_t number_{0};
  bool any_{false};
  bool fresh_{false};  // a sample came since the last export
  std::int64_t run_first_tick_{0};
  std::int64_t first_tick_{0};
  std::int64_t newest_tick_{0};
  std::int64_t first_ns_{0};
  std::int64_t newest_ns_{0};
  std::int64_t due_ns_{0};
  std::unique_ptr<SegmentState> ending_{std::make_unique<SegmentState>()};
  std::unique_ptr<SegmentState> ended_front_{std::make_unique<SegmentState>()};
  SpscRing<SegmentState> ended_{kEnded};
  std::unique_ptr<Latest<SegmentState>> newest_{std::make_unique<Latest<SegmentState>>()};
  std::atomic<std::uint64_t> lost_{0};
  const SegmentState* front_{nullptr};
  std::uint64_t ended_number_{0};  // newest that next() gave
};

/// A segment as state.dls has it.
struct SegmentFile {
  StateAbout about;
  std::string bytes;
};

/// As an identification of that stretch alone would say it. `inputs`: the source first. `boot`: a
/// number of the run, by which its segments are told from another run's where the clock has no
/// date. `alarms`: raised in it.
[[nodiscard]] SegmentFile describe_segment(const SegmentState& segment, const Config& config,
                                           const std::vector<InputFile>& inputs, std::uint64_t boot,
                                           const std::string& alarms);

}  // namespace dampline::app
