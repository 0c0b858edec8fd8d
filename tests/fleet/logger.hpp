// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "app/live/segments.hpp"
#include "app/record/frames.hpp"
#include "dampline/sample/assembler.hpp"
#include "sim_hw/simulated_source.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::app {

/// A logger without a bus: what its spool would be given, in order, states on the way included.
class Logger {
 public:
  explicit Logger(Config config, std::uint64_t seed = 5)
      : config_{std::move(config)}, simulation_{sim::reference_run(sim::Load::kLaden, 80.0, seed)} {
    run_ = std::make_unique<ExplainRun>(
        config_, RecordSignals{channels_.channels, screen_of(channels_.channels)});
    segments_ = std::make_unique<SegmentRun>(config_, *run_);
  }
  static Config config(double segment_s, double every_s) {
    Config out;
    out.record = {"4711", "front", "laden", ""};
    out.model.velocity_corner_hz = 0.7;
    out.spool.segment_s = segment_s;
    out.spool.every_s = every_s;
    return out;
  }
  /// Each jump is added to the time of all frames from that second on.
  struct Jump {
    double at_s{0.0};
    double by_s{0.0};
  };
  std::vector<SegmentFile> drive(double seconds, const std::vector<Jump>& jumps = {}) {
    sim::SimulatedSource source{simulation_, static_cast<std::int64_t>(300.0 * seconds)};
    std::array<CanFrame, 30> frames{};
    std::vector<SegmentFile> out;
    std::int64_t start_ns = 0;
    for (auto count = source.read(frames); count.ok(); count = source.read(frames)) {
      for (std::size_t i = 0; i < count.value(); ++i) {
        CanFrame frame = frames[i];
        if (start_ns == 0) start_ns = frame.time_ns;
        const double at_s = 1e-9 * static_cast<double>(frame.time_ns - start_ns);
        for (const Jump& jump : jumps)
          if (at_s >= jump.at_s) frame.time_ns += static_cast<std::int64_t>(1e9 * jump.by_s);
        run_->take(frame);
      }
      collect(out);
    }
    run_->flush();
    run_->close();
    segments_->finish();
    collect(out);
    return out;
  }
  ExplainRun& run() { return *run_; }

 private:
  void collect(std::vector<SegmentFile>& out) {
    while (segments_->next())
      out.push_back(describe_segment(segments_->front(), config_, {}, 77, ""));
  }
  Config config_;
  sim::SimulationConfig simulation_;
  AssemblerConfig channels_{can_channels(config_)};
  std::unique_ptr<ExplainRun> run_;
  std::unique_ptr<SegmentRun> segments_;
};

/// Of each segment the last state.
inline std::vector<SegmentFile> last_states(const std::vector<SegmentFile>& all) {
  std::vector<SegmentFile> out;
  for (const SegmentFile& file : all) {
    if (!out.empty() && out.back().about.segment == file.about.segment) out.pop_back();
    out.push_back(file);
  }
  return out;
}

}  // namespace dampline::app
