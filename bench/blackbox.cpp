// SPDX-License-Identifier: MIT
// Cost of a frame into the black box and out of it, and what an hour takes on the disk.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "drivers/blackbox/source.hpp"
#include "drivers/blackbox/writer.hpp"

namespace {
using namespace dampline;

constexpr std::int64_t kSecondNs = 1'000'000'000;
constexpr std::int64_t kFramesPerSecond = 900;  // three channels at 300 Hz
constexpr std::int64_t kFrames = 3600 * kFramesPerSecond;

CanFrame frame_at(std::int64_t i) {
  CanFrame frame;
  frame.time_ns = 1'700'000'000 * kSecondNs + i * kSecondNs / kFramesPerSecond / 1000 * 1000;
  frame.id = static_cast<std::uint32_t>(0x310 + i % 3);
  frame.length = 4;
  frame.time_source = TimeSource::kSoftware;
  for (std::size_t k = 0; k < 4; ++k) frame.data[k] = static_cast<std::uint8_t>(i >> (8 * k));
  return frame;
}

std::filesystem::path folder() {
  return std::filesystem::temp_directory_path() / fmt::format("dampline_bench_{}", ::getpid());
}

std::unique_ptr<drivers::BlackboxWriter> open_writer() {
  std::filesystem::remove_all(folder());
  drivers::BlackboxConfig config;
  config.directory = folder();
  config.interfaces = {"can0"};
  auto writer = drivers::BlackboxWriter::open(config);
  if (!writer.ok()) fmt::print(stderr, "{}\n", writer.error_text());
  return std::move(writer.value());
}

/// With ten calls of tick() and one sync for every second of frames.
void put(hal::RecordSink& writer, std::int64_t i) {
  writer.write(frame_at(i));
  if (i % (kFramesPerSecond / 10) == 0) writer.tick(i * kSecondNs / kFramesPerSecond);
}

void write_frame(benchmark::State& state) {
  const auto writer = open_writer();
  std::int64_t i = 0;
  while (state.KeepRunning()) put(*writer, i++);
  writer->close();
  state.counters["MB_per_hour"] = static_cast<double>(writer->health().bytes) * 1e-6 *
                                  static_cast<double>(kFrames) / static_cast<double>(i);
  std::filesystem::remove_all(folder());
}
BENCHMARK(write_frame)->Iterations(kFrames)->Unit(benchmark::kNanosecond);

void read_frame(benchmark::State& state) {
  const auto writer = open_writer();
  for (std::int64_t i = 0; i < kFrames / 10; ++i) put(*writer, i);
  writer->close();
  std::array<CanFrame, 256> frames;
  std::int64_t count = 0;
  while (state.KeepRunning()) {
    auto source = drivers::BlackboxSource::open({folder(), {}});
    for (auto read = source.value()->read(frames); read.ok(); read = source.value()->read(frames))
      count += static_cast<std::int64_t>(read.value());
  }
  state.SetItemsProcessed(count);
  std::filesystem::remove_all(folder());
}
BENCHMARK(read_frame)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
