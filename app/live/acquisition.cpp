// SPDX-License-Identifier: MIT
#include "app/live/acquisition.hpp"

#include <chrono>
#include <cmath>
#include <optional>

namespace dampline::app {
namespace {

constexpr std::chrono::milliseconds kFramePatience{100};

}  // namespace

Acquisition::Acquisition(hal::FrameSource& source, const hal::Clock& clock, ExplainRun& run,
                         const AcquisitionConfig& config)
    : source_{source},
      clock_{clock},
      run_{run},
      period_ns_{std::llround(1e9 / config.sample_rate_hz)},
      publish_interval_ns_{config.publish_interval_ns},
      read_interval_ns_{config.read_interval_ns},
      next_publish_ns_{now_ns() + config.publish_interval_ns},
      items_{config.ring_items},
      newest_sample_ns_{now_ns()} {}

std::int64_t Acquisition::now_ns() const noexcept {
  const std::optional<std::int64_t> now = source_.now_ns();
  return now ? *now : clock_.realtime_ns();
}

void Acquisition::run() noexcept {
  bool more = true;
  while (more && !stop_.load(std::memory_order_acquire)) more = step();
  // What had arrived before the stop belongs to the run, and what the kernel dropped last.
  static_cast<void>(source_.wait(std::chrono::nanoseconds{0}));
  for (auto rest = source_.read(frames_); rest.ok() && rest.value() > 0;
       rest = source_.read(frames_))
    static_cast<void>(take(rest.value()));
  take_events();
  note_faults();
  ended_.store(true, std::memory_order_release);
}

bool Acquisition::step() noexcept {
  const Result<std::size_t> count = source_.read(frames_);
  heartbeats_.fetch_add(1, std::memory_order_release);
  if (!count.ok() && count.error() == Errc::kEndOfStream) return false;
  const std::size_t frames = count.ok() ? count.value() : 0;
  const std::int64_t now = take(frames);
  take_events();
  watch_signal(now);
  publish_when_due(now);
  // A batch that is not full was the last one; a look for another would cost a system call.
  if (frames < kBatch) rest();
  return true;
}

void Acquisition::rest() noexcept {
  const std::int64_t start_ns = clock_.monotonic_ns();
  if (read_interval_ns_ > 0) {
    clock_.sleep_until(start_ns + read_interval_ns_);
  } else if (!source_.wait(kFramePatience).ok()) {  // what cannot even wait must not spin
    clock_.sleep_until(start_ns + std::chrono::nanoseconds{kFramePatience}.count());
  }
}

std::int64_t Acquisition::take(std::size_t count) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    item_.is_event = false;
    item_.frame = frames_[i];
    items_.push(item_);
    run_.take(frames_[i]);
    note_samples();
  }
  const std::int64_t now = now_ns();
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t late_ns = now - frames_[i].time_ns;
    lateness_.add(late_ns);
    if (late_ns > period_ns_) ++slips_;
  }
  return now;
}

void Acquisition::note_samples() noexcept {
  const std::uint64_t now = run_.samples();
  if (now == taken_) return;
  newest_sample_ns_ = run_.newest_time_ns();
  if (taken_ == 0) first_sample_ns_ = clock_.monotonic_ns();
  if (taken_ < kWarmUpSamples && now >= kWarmUpSamples) warm_ = page_faults_of_thread();
  taken_ = now;
  samples_.store(taken_, std::memory_order_release);
}

void Acquisition::take_events() noexcept {
  item_.is_event = true;
  while (source_.next_event(item_.event)) items_.push(item_);
  const hal::SourceHealth health = source_.health();
  dropped_.store(health.dropped, std::memory_order_release);
  link_up_.store(health.link_up, std::memory_order_release);
}

void Acquisition::watch_signal(std::int64_t now_ns) noexcept {
  const bool lost = now_ns - newest_sample_ns_ > kSignalLostNs;
  if (lost == signal_lost_) return;
  signal_lost_ = lost;
  if (lost) silent_since_ns_ = newest_sample_ns_;
  item_.is_event = true;
  item_.event = {now_ns, hal::EventKind::kSignalLost, 0, 0};
  if (!lost)
    item_.event = {now_ns, hal::EventKind::kSignalBack, 0, newest_sample_ns_ - silent_since_ns_};
  items_.push(item_);
}

void Acquisition::publish_when_due(std::int64_t now_ns) noexcept {
  if (now_ns < next_publish_ns_) return;
  next_publish_ns_ += publish_interval_ns_;
  if (next_publish_ns_ <= now_ns) next_publish_ns_ = now_ns + publish_interval_ns_;
  note_faults();
  fill(status_.back());
  status_.publish();
}

void Acquisition::fill(LiveStatus& status) noexcept {
  status.any_sample = !run_.empty();
  if (status.any_sample) status.view = run_.view();
  status.rate = run_.core().assembler().measured_rate();
  status.assembler = run_.core().assembler().counts();
  status.source = source_.health();
  status.lateness = lateness_;
  status.cycle_slips = slips_;
  status.first_sample_ns = first_sample_ns_;
  status.faults = faults_;
}

void Acquisition::note_faults() noexcept {
  if (taken_ < kWarmUpSamples) return;
  const PageFaults now = page_faults_of_thread();
  faults_ = {now.minor - warm_.minor, now.major - warm_.major};
}

void Acquisition::finish() noexcept {
  run_.flush();
  note_samples();
}

LiveStatus Acquisition::final_status() noexcept {
  LiveStatus status;
  fill(status);
  return status;
}

}  // namespace dampline::app
