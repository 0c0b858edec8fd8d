// SPDX-License-Identifier: MIT
// After its warm-up the acquisition neither allocates nor faults.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "app/live/acquisition.hpp"
#include "app/live/explainer.hpp"
#include "app/record/frames.hpp"
#include "app/serve/tap.hpp"
#include "drivers/os/system_clock.hpp"
#include "sim_hw/simulated_source.hpp"
#include "sim_hw/simulation.hpp"
#include "tests/proof/heap_hook.hpp"

namespace dampline::app {
namespace {

constexpr std::size_t kAcquiredSamples = 115'000;

/// Frames made beforehand, so that making them costs nothing now; every 20,000th is missing, and
/// every 30,000th comes twice.
class Prepared final : public hal::FrameSource {
 public:
  Prepared() {
    sim::SimulatedSource source{sim::reference_run(sim::Load::kLaden, 80.0, 3),
                                static_cast<std::int64_t>(kAcquiredSamples)};
    std::vector<CanFrame> batch(3);
    for (auto count = source.read(batch); count.ok(); count = source.read(batch))
      frames_.insert(frames_.end(), batch.begin(),
                     batch.begin() + static_cast<std::ptrdiff_t>(count.value()));
  }

 private:
  Result<std::size_t> do_read(std::span<CanFrame> out) noexcept override {
    std::size_t count = 0;
    for (; count < std::min<std::size_t>(out.size(), 9) && next_ < frames_.size(); ++next_) {
      if (next_ % 20'000 == 19'999) continue;
      out[count++] = frames_[next_];
      if (next_ % 30'000 == 29'999 && count < out.size()) out[count++] = frames_[next_];
    }
    if (count == 0 && next_ == frames_.size()) return Errc::kEndOfStream;
    return count;
  }
  Result<bool> do_wait(std::chrono::nanoseconds /*timeout*/) noexcept override { return true; }
  [[nodiscard]] hal::SourceHealth do_health() const noexcept override { return {}; }
  std::vector<CanFrame> frames_;
  std::size_t next_{0};
};

TEST(AcquisitionHeap, IsNotTouchedByAHundredThousandSamples) {
  Prepared source;
  const drivers::SystemClock clock;
  ExplainRun run{{}, {can_channels({}).channels, {}}};
  LiveExplainer explainer{{}, run};
  MotionTap tap;  // as where a server shows the run
  run.watch([&](const Sample& sample, const UpdateResult& result) { tap.take(sample, result); });
  AcquisitionConfig config;
  config.publish_interval_ns = 2'000'000;  // many snapshots
  const auto acquisition = std::make_unique<Acquisition>(source, clock, run, config);
  RecordItem item;
  Motion motion;
  std::uint64_t moved = 0;
  const auto step = [&] {
    const bool more = acquisition->step();
    while (acquisition->items().pop(item)) continue;
    while (acquisition->samples() % 2 == 0 && tap.pop(motion)) ++moved;
    return more;
  };
  // Samples wait 24 s for the guards before the core touches its memory.
  while (acquisition->samples() < 20'000) ASSERT_TRUE(step());
  const PageFaults before = page_faults_of_thread();
  std::uint64_t calls = 0;
  {
    const proof::HeapWatch watch;
    while (step()) continue;
    calls = proof::HeapWatch::calls();
  }
  const PageFaults after = page_faults_of_thread();
  EXPECT_EQ(calls, 0U);
  EXPECT_EQ(after.minor - before.minor, 0U);
  EXPECT_EQ(after.major - before.major, 0U);
  EXPECT_GT(acquisition->samples(), 110'000U);
  EXPECT_GT(moved, 60'000U);
  EXPECT_EQ(tap.lost(), 0U);
  EXPECT_TRUE(acquisition->status().take());
  EXPECT_TRUE(acquisition->status().front().view.snapshot.valid);
}

}  // namespace
}  // namespace dampline::app
