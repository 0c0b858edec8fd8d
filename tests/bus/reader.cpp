// SPDX-License-Identifier: MIT
#include "tests/bus/reader.hpp"

#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <type_traits>

#include "app/record/frames.hpp"
#include "drivers/os/system_clock.hpp"
#include "drivers/socketcan/source.hpp"

namespace dampline::bus {
namespace {

static_assert(std::is_trivially_copyable_v<ReaderReport>);
constexpr std::chrono::milliseconds kPatience{100};

bool asked_to_end(int pipe) {
  pollfd entry{.fd = pipe, .events = POLLIN, .revents = 0};
  return ::poll(&entry, 1, 0) > 0;
}

void take_events(hal::FrameSource& source, ReaderReport& report) {
  hal::Event event;
  while (source.next_event(event)) ++report.events.at(static_cast<std::size_t>(event.kind));
}

ReaderReport read_until(hal::FrameSource& source, SampleAssembler& assembler, int pipe) {
  ReaderReport report;
  std::array<CanFrame, 256> frames{};
  std::int64_t latest_ns = 0;
  Sample sample;
  for (;;) {
    const auto got = source.read(frames);
    take_events(source, report);
    const std::size_t count = got.ok() ? got.value() : 0;
    for (std::size_t i = 0; i < count; ++i) {
      const std::int64_t step_ns = frames[i].time_ns - latest_ns;
      if (step_ns < 0) ++report.time_went_back;
      if (latest_ns != 0) report.longest_gap_ns = std::max(report.longest_gap_ns, step_ns);
      latest_ns = frames[i].time_ns;
      assembler.push(frames[i]);
      while (assembler.pop(sample)) {
      }
    }
    if (count > 0) continue;
    const auto ready = source.wait(kPatience);
    if (!(ready.ok() && ready.value()) && asked_to_end(pipe)) break;
  }
  assembler.flush();
  report.counts = assembler.counts();
  report.health = source.health();
  report.ledger = ledger_of(report.counts, report.health.dropped);
  return report;
}

void read_bus(const ReaderConfig& config, int input, int output) {
  const AssemblerConfig channels = app::can_channels({});
  const drivers::SystemClock clock;
  drivers::SocketCanConfig can{.interface = config.interface};
  can.receive_buffer_bytes = config.receive_buffer_bytes;
  can.run_time = hal::RunTime::start(clock);
  for (const ChannelConfig& channel : channels.channels)
    if (config.filters) can.identifiers.push_back({channel.id, channel.extended});
  auto source = drivers::SocketCanSource::open(can, clock);
  if (!source.ok()) throw std::runtime_error{source.error_text()};
  const auto assembler = std::make_unique<SampleAssembler>(channels);
  const char ready = 1;
  if (::write(output, &ready, 1) != 1) throw std::runtime_error{"no pipe"};
  const ReaderReport report = read_until(*source.value(), *assembler, input);
  if (::write(output, &report, sizeof report) != ssize_t{sizeof report})
    throw std::runtime_error{"no pipe"};
}

}  // namespace

Reader::Reader(const ReaderConfig& config) {
  std::array<int, 2> to{};
  std::array<int, 2> from{};
  if (::pipe(to.data()) != 0 || ::pipe(from.data()) != 0) throw std::runtime_error{"no pipe"};
  std::fflush(nullptr);
  pid_ = ::fork();
  if (pid_ == 0) {
    ::close(to[1]);
    ::close(from[0]);
    try {
      read_bus(config, to[0], from[1]);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "reader: %s\n", error.what());
    }
    std::fflush(nullptr);
    ::_exit(0);
  }
  ::close(to[0]);
  ::close(from[1]);
  to_reader_ = to[1];
  from_reader_ = from[0];
  char ready = 0;
  if (::read(from_reader_, &ready, 1) != 1) throw std::runtime_error{"the reader did not start"};
}

Reader::~Reader() {
  ::close(to_reader_);
  ::close(from_reader_);
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
}

ReaderReport Reader::finish() {
  const char end = 1;
  ReaderReport report;
  const bool good = ::write(to_reader_, &end, 1) == 1 &&
                    ::read(from_reader_, &report, sizeof report) == ssize_t{sizeof report};
  if (!good) throw std::runtime_error{"the reader ended without a report"};
  return report;
}

}  // namespace dampline::bus
