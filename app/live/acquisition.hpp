// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>

#include "app/identify/truck_run.hpp"
#include "app/live/handover.hpp"
#include "app/live/lateness.hpp"
#include "app/live/process.hpp"
#include "hal/clock.hpp"
#include "hal/frame_source.hpp"

namespace dampline::app {

/// What the acquisition knows at one moment. Plain.
struct LiveStatus {
  bool any_sample{false};
  TruckView view;  ///< of a run with samples
  MeasuredRate rate;
  AssemblerCounts assembler;
  hal::SourceHealth source;
  Lateness lateness;
  std::uint64_t cycle_slips{0};
  PageFaults faults;                ///< since the warm-up
  std::int64_t first_sample_ns{0};  ///< monotonic, when it was complete
};

struct AcquisitionConfig {
  double sample_rate_hz{300.0};  ///< nominal
  std::int64_t publish_interval_ns{10'000'000'000};
  /// 0: frames are read as they arrive. Else so often: fewer wake-ups, later results.
  std::int64_t read_interval_ns{0};
  std::size_t ring_items{16384};  ///< frames that may wait for the writer
};

/// The loop that must keep up: frames from the source to the writer's ring and through assembler
/// and identification. After construction it allocates nothing and opens nothing. One thread calls
/// step() or run(); the other methods say who may call them.
class Acquisition {  // NOLINT(clang-analyzer-optin.performance.Padding): holds such a queue
 public:
  static constexpr std::int64_t kSignalLostNs = 1'000'000'000;
  static constexpr std::uint64_t kWarmUpSamples = 3000;

  Acquisition(hal::FrameSource& source, const hal::Clock& clock, ExplainRun& run,
              const AcquisitionConfig& config);

  /// Until stop() or the end of the source; what the source still holds then is taken.
  void run() noexcept;
  /// One batch of frames, or a wait of at most kFramePatience. False at the end of the source.
  bool step() noexcept;
  /// Any thread.
  void stop() noexcept { stop_.store(true, std::memory_order_release); }

  // For other threads, at any time.
  [[nodiscard]] std::uint64_t heartbeats() const noexcept { return load(heartbeats_); }
  [[nodiscard]] std::uint64_t samples() const noexcept { return load(samples_); }
  [[nodiscard]] std::uint64_t frames_dropped() const noexcept { return load(dropped_); }
  [[nodiscard]] bool link_up() const noexcept { return link_up_.load(std::memory_order_acquire); }
  [[nodiscard]] bool ended() const noexcept { return ended_.load(std::memory_order_acquire); }
  /// For the writer's thread.
  [[nodiscard]] RecordQueue& items() noexcept { return items_; }
  [[nodiscard]] const RecordQueue& items() const noexcept { return items_; }
  /// For the publishing thread.
  [[nodiscard]] Latest<LiveStatus>& status() noexcept { return status_; }

  /// After the thread has ended: takes what the corridor's assembler still holds.
  void finish() noexcept;
  [[nodiscard]] LiveStatus final_status() noexcept;

 private:
  static constexpr std::size_t kBatch = 64;

  static std::uint64_t load(const std::atomic<std::uint64_t>& counter) noexcept {
    return counter.load(std::memory_order_acquire);
  }
  /// Returns the time when their results were there.
  std::int64_t take(std::size_t count) noexcept;
  void rest() noexcept;
  void note_samples() noexcept;
  void take_events() noexcept;
  void watch_signal(std::int64_t now_ns) noexcept;
  void note_faults() noexcept;
  void publish_when_due(std::int64_t now_ns) noexcept;
  void fill(LiveStatus& status) noexcept;
  [[nodiscard]] std::int64_t now_ns() const noexcept;

  hal::FrameSource& source_;
  const hal::Clock& clock_;
  ExplainRun& run_;
  std::int64_t period_ns_;
  std::int64_t publish_interval_ns_;
  std::int64_t read_interval_ns_;
  std::int64_t next_publish_ns_;  // run time
  std::array<CanFrame, kBatch> frames_{};
  RecordItem item_{};
  RecordQueue items_;
  Latest<LiveStatus> status_;
  Lateness lateness_;
  std::uint64_t slips_{0};
  std::uint64_t taken_{0};  // samples
  PageFaults warm_{};
  PageFaults faults_{};
  std::int64_t first_sample_ns_{0};
  std::int64_t newest_sample_ns_{0};  // run time
  bool signal_lost_{false};
  std::int64_t silent_since_ns_{0};
  std::atomic<std::uint64_t> heartbeats_{0};
  std::atomic<std::uint64_t> samples_{0};
  std::atomic<std::uint64_t> dropped_{0};
  std::atomic<bool> link_up_{true};
  std::atomic<bool> stop_{false};
  std::atomic<bool> ended_{false};
};

}  // namespace dampline::app
