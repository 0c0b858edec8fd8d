// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <functional>
#include <latch>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "app/alarm/alarms.hpp"
#include "app/alarm/program.hpp"
#include "app/config/config.hpp"
#include "app/identify/source.hpp"
#include "app/live/acquisition.hpp"
#include "app/live/explainer.hpp"
#include "app/live/process.hpp"
#include "app/live/recorder.hpp"
#include "app/live/segments.hpp"
#include "app/live/status.hpp"
#include "app/run/provenance.hpp"
#include "app/serve/tap.hpp"
#include "hal/clock.hpp"
#include "hal/record_sink.hpp"

namespace dampline::app {

struct LiveOptions {
  double duration_s{0.0};  ///< 0: until a signal
  double publish_every_s{10.0};
  double read_every_s{0.0};   ///< 0: frames are read as they arrive
  int realtime_priority{50};  ///< 0: ordinary scheduling
  bool record{true};          ///< the sink is a black box, not a void
};

/// What a live run is made of; all of it outlives the run.
struct LiveParts {
  std::string name;  ///< of the source, "can0"
  hal::FrameSource* source{nullptr};
  hal::RecordSink* sink{nullptr};
  const hal::Clock* clock{nullptr};
  hal::RunTime run_time;
  std::vector<InputFile> inputs{};  ///< the interface, and what else went in
  MotionTap* tap{nullptr};          ///< where a server gets the motion from; null: nobody asks
};

/// How a live run stands, some times a second.
struct LiveTurn {
  LiveState state{LiveState::kWaiting};
  bool alarm{false};            ///< one of [alarm] is raised
  std::uint64_t heartbeats{0};  ///< how often the acquisition's loop has come round
  std::uint64_t samples{0};
  std::int64_t silence_ns{0};  ///< since the newest sample
  std::int64_t now_ns{0};      ///< monotonic
};

/// What the main thread tells the world; each is called from the thread that called run().
struct LiveOutlets {
  std::function<void(Recorder&)> begin{};  ///< the threads run
  /// Every publish_every_s. What it throws is counted and told as an event, and ends no run.
  std::function<void(const RunResult&)> publish{};
  /// What they have to tell of themselves goes into a result before it is published.
  std::function<void(RunResult&)> describe{};
  /// A later state of a segment, and the alarms raised in it; absent: there are no segments.
  std::function<void(const SegmentState&, const std::string&)> segment{};
  /// An alarm was raised or went, at that time of the record.
  std::function<void(const AlarmChange&, double)> alarm{};
  /// Some times a second.
  std::function<void(const LiveTurn&)> turn{};
  std::function<void()> rotated{};  ///< after SIGHUP
  std::function<void()> end{};      ///< the recorder is about to go
};

/// Identification of a live bus: an acquisition thread that must keep up, a writer's thread that
/// may wait for a disk, and the caller's thread, which publishes and listens for signals. A lost
/// signal is waited out. Ends after the duration, on SIGINT or SIGTERM, or with its source.
class LiveRun {
 public:
  LiveRun(const Config& config, const AssemblerConfig& assembler, const LiveParts& parts,
          const LiveOptions& options, LiveOutlets outlets);
  /// Throws RunError when nothing could be identified; the black box is complete all the same.
  [[nodiscard]] Identified run();

 private:
  void acquire();
  void watch(const Signals& signals);
  void rotate();
  void publish_when_fresh();
  void publish(const RunResult& result);
  void raise_alarms(RunResult& result);
  void pass_segments();
  void forget_alarms();
  void describe_segments(RunResult& result) const;
  [[nodiscard]] LiveSurroundings surroundings(const std::string& state) const;
  [[nodiscard]] Identified conclude();
  void note(hal::EventKind kind, std::int64_t value);

  Config config_;
  std::array<ChannelConfig, kChannels> channels_;
  LiveParts parts_;
  LiveOptions options_;
  LiveOutlets outlets_;
  ExplainRun truck_;
  std::unique_ptr<SegmentRun> segments_;  // null: nobody wants them
  LiveExplainer explainer_;
  std::unique_ptr<Acquisition> acquisition_;
  Recorder recorder_;
  Monitor monitor_;
  Alarms alarms_;
  std::set<std::string> raised_;  // in the segment that goes on
  AlarmProgram alarm_program_;
  Realtime realtime_;  // written before the threads are told apart, and by acquire()
  std::latch ready_{1};
  std::int64_t start_ns_;
  std::int64_t silence_ns_{0};
  LiveState state_{LiveState::kWaiting};
  std::uint64_t publish_failures_{0};
  std::uint64_t failed_in_a_row_{0};
};

}  // namespace dampline::app
