// SPDX-License-Identifier: MIT
// Cost of the way from a log to samples: a candump line, a frame of the assembler, a row of a
// table.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "dampline/sample/assembler.hpp"
#include "dampline/sample/screen.hpp"
#include "drivers/candump/source.hpp"
#include "drivers/csv/reader.hpp"

namespace {
using namespace dampline;

constexpr std::int64_t kStartNs = 1'600'000'000'000'000'000;
constexpr std::int64_t kTicks = 100'000;

CanFrame frame_at(std::int64_t tick, std::size_t channel) {
  CanFrame frame;
  frame.id = static_cast<std::uint32_t>(0x100 + channel);
  frame.length = 4;
  frame.time_ns = kStartNs + tick * 10'000'000 / 3 + static_cast<std::int64_t>(channel) * 200'000;
  const auto counts = static_cast<std::uint64_t>((tick * 37 + 11) % 4000 - 2000) & 0xFFFU;
  const std::uint64_t bits = counts | (static_cast<std::uint64_t>(tick) & 0xFFFU) << 12U;
  for (std::size_t i = 0; i < 4; ++i) frame.data[i] = static_cast<std::uint8_t>(bits >> (8 * i));
  return frame;
}

AssemblerConfig assembler_config() {
  AssemblerConfig config;
  for (std::size_t c = 0; c < kChannels; ++c) {
    config.channels[c].id = static_cast<std::uint32_t>(0x100 + c);
    config.channels[c].accel = {.start_bit = 0, .length = 12, .is_signed = true, .scale = 0.05};
    config.channels[c].has_counter = true;
    config.channels[c].counter = {.start_bit = 12, .length = 12};
  }
  return config;
}

/// A file in the temporary directory for the time of one benchmark.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& text)
      : path_{std::filesystem::temp_directory_path() /
              fmt::format("dampline_bench_{}", ::getpid())} {
    std::ofstream{path_, std::ios::binary} << text;
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

std::string candump_text(std::size_t bytes) {
  std::string text;
  for (std::int64_t tick = 0; tick < kTicks; ++tick) {
    for (std::size_t c = 0; c < kChannels; ++c) {
      const CanFrame frame = frame_at(tick, c);
      text += fmt::format("({}.{:06}) can0 {:03X}#", frame.time_ns / 1'000'000'000,
                          frame.time_ns / 1000 % 1'000'000, frame.id);
      for (std::size_t i = 0; i < bytes; ++i) text += fmt::format("{:02X}", frame.data[i]);
      text += '\n';
    }
  }
  return text;
}

void candump_line(benchmark::State& state) {
  const TemporaryFile file{candump_text(static_cast<std::size_t>(state.range(0)))};
  std::array<CanFrame, 64> frames;
  std::uint64_t lines = 0;
  while (state.KeepRunning()) {
    auto source = drivers::CandumpSource::open({.path = file.path()});
    for (auto count = source.value()->read(frames); count.ok();
         count = source.value()->read(frames)) {
      benchmark::DoNotOptimize(frames);
    }
    lines += source.value()->health().frames;
  }
  state.counters["per_line"] = benchmark::Counter(
      static_cast<double>(lines), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(candump_line)->Arg(4)->Arg(8)->ArgName("payload")->Unit(benchmark::kMillisecond);

void assembler_frame(benchmark::State& state) {
  std::vector<CanFrame> frames;
  for (std::int64_t tick = 0; tick < kTicks; ++tick) {
    for (std::size_t c = 0; c < kChannels; ++c) frames.push_back(frame_at(tick, c));
  }
  while (state.KeepRunning()) {
    SampleAssembler assembler{assembler_config()};
    Sample sample;
    for (const CanFrame& frame : frames) {
      assembler.push(frame);
      while (assembler.pop(sample)) benchmark::DoNotOptimize(sample);
    }
  }
  state.counters["per_frame"] = benchmark::Counter(
      static_cast<double>(frames.size()),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(assembler_frame)->Unit(benchmark::kMillisecond);

void foreign_frame(benchmark::State& state) {
  SampleAssembler assembler{assembler_config()};
  CanFrame frame;
  frame.id = 0x7FF;
  while (state.KeepRunning()) {
    assembler.push(frame);
    benchmark::DoNotOptimize(assembler);
  }
}
BENCHMARK(foreign_frame);

void screened_sample(benchmark::State& state) {
  SampleScreen screen{ScreenConfig{}};
  Screened out;
  Sample sample;
  const bool still = state.range(0) != 0;
  while (state.KeepRunning()) {
    ++sample.tick;
    if (!still)
      sample.accel_mps2 = {static_cast<double>(sample.tick % 7),
                           1.0 - static_cast<double>(sample.tick % 5),
                           0.5 * static_cast<double>(sample.tick % 3)};
    benchmark::DoNotOptimize(screen.push(sample, out));
  }
}
BENCHMARK(screened_sample)->Arg(0)->Arg(1)->ArgName("standstill");

void csv_row(benchmark::State& state) {
  std::string text = "time_s,frame_accel_mps2,wheelset1_accel_mps2,wheelset2_accel_mps2\n";
  for (std::int64_t tick = 0; tick < kTicks; ++tick) {
    const double accel_mps2 = 0.05 * static_cast<double>((tick * 37 + 11) % 4000 - 2000);
    text += fmt::format("{:.6f},{:.4f},{:.4f},{:.4f}\n", static_cast<double>(tick) / 300.0,
                        accel_mps2, 0.7 * accel_mps2, -accel_mps2);
  }
  const TemporaryFile file{text};
  std::array<double, 256> rows{};
  std::uint64_t count = 0;
  while (state.KeepRunning()) {
    auto reader =
        drivers::CsvReader::open({.path = file.path(),
                                  .required = {"time_s", "frame_accel_mps2", "wheelset1_accel_mps2",
                                               "wheelset2_accel_mps2"}});
    for (auto read = reader.value()->read(rows); read.ok(); read = reader.value()->read(rows))
      benchmark::DoNotOptimize(rows);
    count += reader.value()->health().rows;
  }
  state.counters["per_row"] = benchmark::Counter(
      static_cast<double>(count), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(csv_row)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
