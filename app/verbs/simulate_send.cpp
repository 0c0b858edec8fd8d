// SPDX-License-Identifier: MIT
#include "app/verbs/simulate_send.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "app/error.hpp"
#include "app/text/format.hpp"
#include "app/verbs/output.hpp"
#include "drivers/os/system_clock.hpp"
#include "drivers/socketcan/sender.hpp"

namespace dampline::app {
namespace {

std::unique_ptr<drivers::CanSender> open_sender(const std::string& interface,
                                                const hal::Clock& clock) {
  auto sender = drivers::CanSender::open(interface, clock);
  if (!sender.ok()) throw RunError(sender.error_text());
  return std::move(sender.value());
}

/// The frames of some sample instants, in the order in which the sensors send them.
class Batches {
 public:
  Batches(const SimulateOptions& options, const SimulatedRun& run)
      : simulation_{run.simulation},
        nodes_{run.nodes, run.simulation.seed},
        transport_{run.transport, run.simulation.seed},
        truth_{options.truth, run.simulation, options.force},
        most_{options.batch_ticks},
        left_{run.samples},
        extras_{run.simulation.extra_sensors} {
    frames_.reserve(static_cast<std::size_t>(most_) * sim::kMaxFramesPerTick);
  }
  /// False: the run is over.
  bool next() {
    frames_.clear();
    const std::int64_t ticks = std::min(most_, left_);
    for (std::int64_t i = 0; i < ticks; ++i) {
      const sim::SimulatedSample sample = simulation_.next();
      const auto arrived = transport_.pass(nodes_.pack(sample), sample.time_s);
      frames_.insert(frames_.end(), arrived.begin(), arrived.end());
      if (extras_) {
        const auto more = nodes_.pack_extras(sample);
        frames_.insert(frames_.end(), more.begin(), more.end());
      }
      truth_.append(sample);
    }
    left_ -= ticks;
    return ticks > 0;
  }
  void close() { truth_.close(); }
  [[nodiscard]] const std::vector<CanFrame>& frames() const { return frames_; }
  [[nodiscard]] std::int64_t left() const { return left_; }

 private:
  sim::Simulation simulation_;
  sim::SensorNodes nodes_;
  sim::Transport transport_;
  TruthFile truth_;
  std::int64_t most_;
  std::int64_t left_;
  bool extras_;
  std::vector<CanFrame> frames_;
};

void print_summary(const SimulateOptions& options, std::int64_t samples,
                   const drivers::SenderHealth& health) {
  tell(fmt::format("simulate: {:.6g} s, {} frames sent, {} not sent -> {}\n",
                   static_cast<double>(samples) / sim::kSampleRateHz, health.sent, health.not_sent,
                   options.to));
}

}  // namespace

void check_sending(const SimulateOptions& options) {
  const auto refuse = [](std::string_view text) { throw UsageError(std::string{text}); };
  if (options.to.empty()) {
    if (options.speed != 1.0 || options.asap || options.batch_ticks != 1) {
      refuse("--speed, --asap and --batch are for sending, expected --to INTERFACE too");
    }
    return;
  }
  if (options.out != "-" || !options.format.empty()) {
    refuse("--to: sends frames, expected no --out and no --format");
  }
  if (!(options.speed > 0.0 && options.speed <= 1e6)) {
    refuse(fmt::format("--speed: {}, expected a factor above 0, at most 1e6", options.speed));
  }
  if (options.asap && options.speed != 1.0) refuse("--asap: has no speed, expected no --speed");
  if (options.batch_ticks < 1 || options.batch_ticks > 100'000) {
    refuse(fmt::format("--batch: {}, expected 1 to 100000 sample instants", options.batch_ticks));
  }
}

void send_run(const SimulateOptions& options, const SimulatedRun& run) {
  const drivers::SystemClock clock;
  const std::unique_ptr<drivers::CanSender> sender = open_sender(options.to, clock);
  const StopRequest stop;
  FrameSchedule schedule{clock, options.asap ? 0.0 : options.speed};
  Batches batches{options, run};
  const SimulateProgress progress{run.samples, options.quiet};
  std::int64_t done = 0;
  while (batches.next()) {
    const std::vector<CanFrame>& frames = batches.frames();
    if (!frames.empty()) {
      schedule.start(frames.front().time_ns);
      if (!schedule.wait_for(frames.back().time_ns, stop)) break;
      sender->send(frames);
    }
    done = run.samples - batches.left();
    progress.at(done);
  }
  progress.end();
  batches.close();
  if (!options.quiet) print_summary(options, done, sender->health());
}

void FrameSchedule::start(std::int64_t first_ns) noexcept {
  if (started_) return;
  started_ = true;
  first_ns_ = first_ns;
  start_ns_ = clock_.monotonic_ns();
}

std::int64_t FrameSchedule::due_ns(std::int64_t time_ns) const noexcept {
  const std::int64_t since_ns = time_ns - first_ns_;
  if (speed_ == 0.0) return start_ns_;
  if (speed_ == 1.0) return start_ns_ + since_ns;
  return start_ns_ + std::llround(static_cast<double>(since_ns) / speed_);
}

// In slices: a signal that comes just before a sleep does not cut it short.
bool FrameSchedule::wait_for(std::int64_t time_ns, const StopRequest& stop) const noexcept {
  constexpr std::int64_t kSliceNs = 100'000'000;
  if (speed_ == 0.0) return !stop.made();
  const std::int64_t due = due_ns(time_ns);
  while (!stop.made()) {
    const std::int64_t now_ns = clock_.monotonic_ns();
    if (now_ns >= due) return true;
    clock_.sleep_until(std::min(due, now_ns + kSliceNs));
  }
  return false;
}

}  // namespace dampline::app
