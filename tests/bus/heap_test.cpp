// SPDX-License-Identifier: MIT
// The acquisition on a real socket, in this thread: after the warm-up no call of the heap.
#include <gtest/gtest.h>

#include <memory>
#include <optional>

#include "app/live/acquisition.hpp"
#include "app/record/frames.hpp"
#include "drivers/os/system_clock.hpp"
#include "drivers/socketcan/source.hpp"
#include "tests/bus/bus.hpp"
#include "tests/bus/live_program.hpp"
#include "tests/proof/heap_hook.hpp"

namespace dampline::bus {
namespace {

TEST(TimeTravelHeap, TheWatchSeesAnAllocation) {
  const proof::HeapWatch watch;
  const auto number = std::make_unique<std::array<int, 100>>();
  EXPECT_NE(number.get(), nullptr);
  EXPECT_GT(watch.calls(), 0U);
}

TEST(TimeTravelHeap, AHundredThousandSamplesAllocateNothing) {
  constexpr std::uint64_t kSamples = 100'000;
  const Folder folder;
  const VirtualCan bus;
  const drivers::SystemClock clock;
  const app::Config config;
  app::AcquisitionConfig settings;
  settings.publish_interval_ns = 1'000'000'000;
  drivers::SocketCanConfig can{.interface = bus.name()};
  can.run_time = hal::RunTime::start(clock);
  const auto source = drivers::SocketCanSource::open(can, clock);
  ASSERT_TRUE(source.ok()) << source.error_text();
  app::ExplainRun truck{config, {app::can_channels(config).channels, {}}};
  app::Acquisition acquisition{*source.value(), clock, truck, settings};
  Child simulate{simulate_command(bus.name(), 345.0, 10), folder.path()};
  const auto run_to = [&](std::uint64_t samples) {
    app::RecordItem item;
    std::uint64_t recorded = 0;
    while (acquisition.samples() < samples && acquisition.step())
      while (acquisition.items().pop(item)) ++recorded;
    return recorded;
  };
  run_to(app::Acquisition::kWarmUpSamples);
  const proof::HeapWatch watch;
  const std::uint64_t recorded = run_to(app::Acquisition::kWarmUpSamples + kSamples);
  EXPECT_EQ(watch.calls(), 0U);
  EXPECT_GE(recorded, 3 * kSamples);
  EXPECT_EQ(acquisition.frames_dropped(), 0U);
}

}  // namespace
}  // namespace dampline::bus
