// SPDX-License-Identifier: MIT
// The live run over interfaces: no bus, a simulated source, a sink in memory.
#include "app/live/run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/diagnosis/truck/explain.hpp"
#include "app/diagnosis/truck/explanation.hpp"
#include "app/error.hpp"
#include "app/record/frames.hpp"
#include "app/run/state.hpp"
#include "dampline/sample/assembler.hpp"
#include "drivers/candump/line.hpp"
#include "drivers/os/system_clock.hpp"
#include "sim_hw/effects/registry.hpp"
#include "sim_hw/simulated_source.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::app {
namespace {

constexpr std::int64_t kSamples = 120 * 300;

class MemorySink final : public hal::RecordSink {
 public:
  std::vector<CanFrame> frames;
  std::atomic<std::size_t> written{0};  // frames, for other threads
  std::vector<hal::Event> events;
  bool closed{false};
  int rotations{0};
  std::chrono::milliseconds pause{0};

 private:
  void do_write(const CanFrame& frame) noexcept override {
    frames.push_back(frame);
    ++health_.frames;
    written.store(frames.size(), std::memory_order_release);
    if (pause.count() > 0 && frames.size() == 1) std::this_thread::sleep_for(pause);
  }
  void do_write(const hal::Event& event) noexcept override { events.push_back(event); }
  void do_tick(std::int64_t /*monotonic_ns*/) noexcept override {}
  void do_rotate() noexcept override { ++rotations; }
  void do_close() noexcept override { closed = true; }
  [[nodiscard]] hal::RecordHealth do_health() const noexcept override { return health_; }
  hal::RecordHealth health_;
};

/// Slow enough for a writer, however slow the machine: it is never half a ring ahead.
class Paced final : public hal::FrameSource {
 public:
  Paced(std::unique_ptr<hal::FrameSource> inner, const MemorySink& sink)
      : inner_{std::move(inner)}, sink_{sink} {}

 private:
  static constexpr std::size_t kAhead = 8192;
  Result<std::size_t> do_read(std::span<CanFrame> out) noexcept override {
    std::this_thread::sleep_for(std::chrono::milliseconds{1});
    if (read_ > sink_.written.load(std::memory_order_acquire) + kAhead) return std::size_t{0};
    const auto count = inner_->read(out);
    if (count.ok()) read_ += count.value();
    return count;
  }
  Result<bool> do_wait(std::chrono::nanoseconds /*timeout*/) noexcept override { return true; }
  [[nodiscard]] hal::SourceHealth do_health() const noexcept override { return inner_->health(); }
  std::unique_ptr<hal::FrameSource> inner_;
  const MemorySink& sink_;
  std::size_t read_{0};
};

/// Gives some seconds of the record for each result that was published, however slow the machine.
class Followed final : public hal::FrameSource {
 public:
  explicit Followed(std::unique_ptr<hal::FrameSource> inner) : inner_{std::move(inner)} {}
  void go_on() noexcept { allowed_ += kFrames; }

 private:
  static constexpr std::size_t kFrames = 3 * 300 * kChannels;
  Result<std::size_t> do_read(std::span<CanFrame> out) noexcept override {
    if (read_ >= allowed_) return std::size_t{0};
    const auto count = inner_->read(out);
    if (count.ok()) read_ += count.value();
    return count;
  }
  Result<bool> do_wait(std::chrono::nanoseconds /*timeout*/) noexcept override {
    std::this_thread::sleep_for(std::chrono::milliseconds{1});
    return true;
  }
  [[nodiscard]] hal::SourceHealth do_health() const noexcept override { return inner_->health(); }
  std::unique_ptr<hal::FrameSource> inner_;
  std::size_t read_{0};
  std::atomic<std::size_t> allowed_{kFrames};
};

/// Delivers what the inner source has, then stays silent for ever instead of ending.
class Silent final : public hal::FrameSource {
 public:
  explicit Silent(std::unique_ptr<hal::FrameSource> inner) : inner_{std::move(inner)} {}

 private:
  Result<std::size_t> do_read(std::span<CanFrame> out) noexcept override {
    if (!inner_) return std::size_t{0};
    const auto count = inner_->read(out);
    if (!count.ok()) return std::size_t{0};
    return count;
  }
  Result<bool> do_wait(std::chrono::nanoseconds timeout) noexcept override {
    std::this_thread::sleep_for(timeout);
    return false;
  }
  [[nodiscard]] hal::SourceHealth do_health() const noexcept override {
    return inner_ ? inner_->health() : hal::SourceHealth{};
  }
  std::unique_ptr<hal::FrameSource> inner_;
};

std::unique_ptr<hal::FrameSource> simulated() {
  return std::make_unique<sim::SimulatedSource>(sim::reference_run(sim::Load::kLaden, 80.0, 5),
                                                kSamples);
}

class LiveRunTest : public ::testing::Test {
 protected:
  Identified run(hal::FrameSource& source, const LiveOptions& options = {.realtime_priority = 0},
                 LiveOutlets outlets = {}, const Config& config = {}) {
    const LiveParts parts{"fake0", &source, &sink_, &clock_, hal::RunTime::start(clock_)};
    return LiveRun{config, can_channels({}), parts, options, std::move(outlets)}.run();
  }
  drivers::SystemClock clock_;
  MemorySink sink_;
};

/// The same frames without threads.
std::string state_of(hal::FrameSource& source) {
  const AssemblerConfig config = can_channels({});
  TruckRun<kIdentifyParts> truck{{}, {config.channels, screen_of(config.channels)}};
  std::array<CanFrame, 7> frames;
  for (auto count = source.read(frames); count.ok(); count = source.read(frames))
    for (std::size_t i = 0; i < count.value(); ++i) truck.take(frames[i]);
  truck.flush();
  static_cast<void>(truck.finish(truck.core().assembler().measured_rate(), "reference"));
  return encode_state(*truck.statistics());
}

TEST_F(LiveRunTest, GivesTheSameBytesAsTheSameFramesWithoutThreads) {
  Paced live{simulated(), sink_};
  const Identified found = run(live);
  const auto reference = simulated();
  EXPECT_EQ(encode_state(*found.sums), state_of(*reference));
  EXPECT_EQ(sink_.frames.size(), kSamples * kChannels);
  EXPECT_TRUE(sink_.closed);
  ASSERT_GE(sink_.events.size(), 2U);
  EXPECT_EQ(sink_.events.front().kind, hal::EventKind::kRunStart);
  EXPECT_EQ(sink_.events.back().kind, hal::EventKind::kRunEnd);
  EXPECT_EQ(sink_.events.back().value, kSamples * static_cast<std::int64_t>(kChannels));
  ASSERT_TRUE(found.result.live.has_value());
  EXPECT_EQ(found.result.live->state, "ended");
}

/// explanation.json of a file with these frames.
nlohmann::json explanation_of(const std::vector<CanFrame>& frames) {
  fmt::memory_buffer text;
  for (const CanFrame& frame : frames) drivers::append_candump(text, frame, "can0");
  const auto path = std::filesystem::temp_directory_path() /
                    ("dampline_live_equals_file_" + std::to_string(::getpid()) + ".log");
  std::ofstream{path} << std::string_view{text.data(), text.size()};
  const std::string found = to_json(explain_truck({}, {{path.string(), false}, {}, false}));
  std::filesystem::remove(path);
  return nlohmann::json::parse(found);
}

TEST_F(LiveRunTest, ExplainsWhatAFileOfTheSameFramesDoes) {
  sim::SimulationConfig config = sim::reference_run(sim::Load::kLaden, 80.0, 6);
  ASSERT_FALSE(sim::add_effect_text(config, "viscous:coefficient_nspm=110000"));
  Paced source{std::make_unique<sim::SimulatedSource>(config, kSamples), sink_};
  const Identified found = run(source);
  const auto live = nlohmann::json::parse(found.result.evidence.explanation);
  const nlohmann::json file = explanation_of(sink_.frames);
  EXPECT_EQ(live.at("steps").at(0).at("effect"), "viscous");
  for (const char* key : {"verdict", "trust", "rejected", "faults"})
    EXPECT_EQ(live.at(key), file.at(key)) << key;
  for (const char* model : {"base", "final"})
    for (const char* key : {"terms", "held_out_nmse"})
      EXPECT_EQ(live.at(model).at(key), file.at(model).at(key)) << model;
  ASSERT_EQ(live.at("steps").size(), file.at("steps").size());
  for (const char* key : {"effect", "parameters", "held_out_nmse_after", "runners_up"})
    EXPECT_EQ(live.at("steps").at(0).at(key), file.at("steps").at(0).at(key)) << key;
  EXPECT_GT(live.at("floor_nmse").get<double>(), 0.0);  // of the newest minutes
}

TEST_F(LiveRunTest, PublishesOnTheWayAndTellsWhenTheSignalIsLost) {
  Silent source{std::make_unique<Paced>(simulated(), sink_)};
  std::vector<RunResult> published;
  bool identifying = false;
  bool degraded = false;  // silent for more than a second
  const auto turn = [&](const LiveTurn& now) {
    identifying = identifying || now.state == LiveState::kIdentifying;
    degraded = identifying && now.state == LiveState::kDegraded;
    if (degraded) ::raise(SIGTERM);
  };
  const Identified found =
      run(source, {.duration_s = 100.0, .publish_every_s = 0.5, .realtime_priority = 0},
          {.publish = [&](const RunResult& r) { published.push_back(r); }, .turn = turn});
  EXPECT_TRUE(degraded);
  ASSERT_GE(published.size(), 2U);
  EXPECT_EQ(published.back().parameters.at(0).name, "coulomb");
  EXPECT_GT(published.back().live->lateness_max_us, 0.0);
  std::uint64_t late = 0;
  for (const LatenessRow& row : found.result.lateness) late += row.frames;
  std::uint64_t frames = 0;
  for (const auto& [name, count] : found.result.counts)
    if (name == "frames") frames = count;
  EXPECT_GT(frames, 0U);
  EXPECT_EQ(late, frames);
  std::vector<std::string> names;
  for (const RunEvent& event : found.result.events) names.push_back(event.name);
  EXPECT_THAT(names, ::testing::Contains("signal_lost"));
}

TEST_F(LiveRunTest, ASegmentSaysWhichAlarmsWereRaisedInIt) {
  Config config;
  config.record = {"4711", "front", "", ""};
  config.spool.segment_s = 10.0;
  config.alarm.coulomb_below_n = 20'000.0;
  config.alarm.coulomb_above_n = 20'000.0;
  config.alarm.hold_s = 30.0;
  Followed source{simulated()};
  std::vector<std::string> alarms;  // of the last state of each segment
  std::uint64_t newest = 0;
  const auto take = [&](const SegmentState& state, const std::string& names) {
    if (state.number == newest) alarms.pop_back();
    newest = state.number;
    alarms.push_back(describe_segment(state, config, {}, 1, names).about.alarms);
  };
  static_cast<void>(run(source, {.publish_every_s = 0.02, .realtime_priority = 0},
                        {.publish = [&](const RunResult&) { source.go_on(); }, .segment = take},
                        config));
  ASSERT_GE(alarms.size(), 8U);
  EXPECT_EQ(alarms.front(), "");  // it has not lasted
  EXPECT_EQ(alarms.back(), "coulomb_below");
}

TEST_F(LiveRunTest, EndsAfterItsDuration) {
  Silent source{simulated()};
  const auto start = std::chrono::steady_clock::now();
  static_cast<void>(run(source, {.duration_s = 1.5, .realtime_priority = 0}));
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  EXPECT_GE(took.count(), 1.4);
}

TEST_F(LiveRunTest, StopsOnASignalAndRotatesOnAnother) {
  Silent source{std::make_unique<Paced>(simulated(), sink_)};
  int turns = 0;
  const Identified found = run(source, {.realtime_priority = 0}, {.turn = [&](const LiveTurn&) {
                                 if (++turns == 3) ::raise(SIGHUP);
                                 if (turns == 30) ::raise(SIGTERM);
                               }});
  EXPECT_EQ(sink_.rotations, 1);
  EXPECT_EQ(found.result.parameters.at(0).name, "coulomb");
}

TEST_F(LiveRunTest, SaysWhatThereWasWhenNoSampleCame) {
  Silent source{nullptr};
  try {
    static_cast<void>(run(source, {.duration_s = 0.3, .realtime_priority = 0}));
    FAIL();
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("fake0: not one complete sample: of 0 frames"));
  }
  EXPECT_TRUE(sink_.closed);
}

TEST_F(LiveRunTest, CountsWhatASlowDiskCouldNotTakeAndIdentifiesAllTheSame) {
  sink_.pause = std::chrono::seconds{2};
  const auto live = simulated();
  const Identified found = run(*live);
  const auto reference = simulated();
  EXPECT_EQ(encode_state(*found.sums), state_of(*reference));
  std::int64_t lost = 0;
  for (const hal::Event& event : sink_.events)
    if (event.kind == hal::EventKind::kRecordsLost) lost += event.value;
  EXPECT_GT(lost, 0);
  EXPECT_EQ(sink_.frames.size() + static_cast<std::size_t>(lost), kSamples * kChannels);
}

TEST_F(LiveRunTest, TheEventsBeforeTheStartStandBeforeWhatTheRingsHold) {
  RecordQueue items{16};
  items.push({.is_event = true, .event = {2, hal::EventKind::kLinkDown, 0, 0}});
  Recorder recorder{sink_, clock_, items};
  recorder.add({1, hal::EventKind::kRunStart, 0, 0});
  recorder.start();
  recorder.stop();
  ASSERT_EQ(sink_.events.size(), 2U);
  EXPECT_EQ(sink_.events[0].kind, hal::EventKind::kRunStart);
  EXPECT_EQ(sink_.events[1].kind, hal::EventKind::kLinkDown);
}

TEST(Judge, ToldByTheWorst) {
  const Condition good{.any_sample = true};
  EXPECT_EQ(judge(good), LiveState::kIdentifying);
  EXPECT_EQ(judge({}), LiveState::kWaiting);
  EXPECT_EQ(judge({.any_sample = true, .link_up = false}), LiveState::kFault);
  EXPECT_EQ(judge({.any_sample = true, .recording = false}), LiveState::kDegraded);
  EXPECT_EQ(judge({.any_sample = true, .lost_lately = true}), LiveState::kDegraded);
  EXPECT_EQ(judge({.any_sample = true, .silence_ns = kSilenceNs + 1}), LiveState::kDegraded);
  EXPECT_EQ(judge({.any_sample = true, .silence_ns = kFaultNs + 1}), LiveState::kFault);
}

}  // namespace
}  // namespace dampline::app
