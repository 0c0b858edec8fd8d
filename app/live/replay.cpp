// SPDX-License-Identifier: MIT
#include "app/live/replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <thread>

#include "app/alarm/alarms.hpp"
#include "app/error.hpp"
#include "app/identify/source.hpp"
#include "app/live/explainer.hpp"
#include "app/live/process.hpp"
#include "app/live/status.hpp"
#include "app/record/rate.hpp"
#include "app/run/json.hpp"
#include "app/run/provenance.hpp"
#include "app/serve/serving.hpp"

namespace dampline::app {
namespace {

using std::chrono::duration;
using WallClock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kReplayTurn{20};

/// A record on its way through what a live run has.
class Replay {
 public:
  Replay(const Config& config, const SourceOptions& source, SourceKind kind,
         const ReplayOptions& options)
      : config_{config},
        source_{source},
        options_{options},
        serving_{open_serving(config)},
        feed_{open_feed(config, source, kind)},
        run_{config, feed_->signals()},
        explainer_{config, run_, LiveExplainer::Pace::kWaits},
        alarms_{config.alarm},
        progress_{options.show_progress} {
    if (!serving_) throw UsageError{"--serve: missing, expected HOST:PORT as in 127.0.0.1:9464"};
    run_.watch([tap = &serving_->tap()](const Sample& sample, const UpdateResult& result) {
      tap->take(sample, result);
    });
    inputs_ = {describe_record(source.path)};
  }

  [[nodiscard]] RunResult play() {
    explainer_.start();
    start_ = WallClock::now();
    next_publish_ = start_ + publish_interval();
    for (bool more = true; more && !stop_.made();) {
      const Batch batch = feed_->read();
      for (const CanFrame& frame : batch.frames) take(frame);
      for (const Sample& sample : batch.samples) take(sample);
      more = batch.more;
    }
    run_.flush();
    explainer_.stop();
    RunResult result = finish();
    while (!options_.end && !stop_.made()) std::this_thread::sleep_for(kReplayTurn);
    return result;
  }

 private:
  [[nodiscard]] WallClock::duration publish_interval() const {
    constexpr double kOfRecordS = 10.0;
    const double of_record = options_.speed > 0.0 ? kOfRecordS / options_.speed : 0.0;
    const double every_s = options_.publish_every_s > 0.0 ? options_.publish_every_s
                                                          : std::clamp(of_record, 0.5, kOfRecordS);
    return std::chrono::duration_cast<WallClock::duration>(duration<double>{every_s});
  }

  template <class Item>
  void take(const Item& item) {
    if (stop_.made()) return;
    run_.take(item);
    // A look at the clock for every 20 ms of the record; most samples need none.
    if (run_.time_s() - looked_at_s_ < look_every_s()) return;
    looked_at_s_ = run_.time_s();
    do turn();
    while (is_early() && !stop_.made());
  }
  [[nodiscard]] double look_every_s() const {
    constexpr double kEveryS = 0.02;
    return kEveryS * std::max(1.0, options_.speed > 0.0 ? options_.speed : 10.0);
  }
  [[nodiscard]] bool is_early() const {
    if (options_.speed <= 0.0) return false;
    const duration<double> passed = WallClock::now() - start_;
    const double ahead_s = looked_at_s_ / options_.speed - passed.count();
    if (ahead_s <= 0.0) return false;
    std::this_thread::sleep_for(std::min<duration<double>>(kReplayTurn, duration<double>{ahead_s}));
    return true;
  }

  void turn() {
    serving_->turn({"identifying", run_.samples(), 0.0});
    if (progress_.due()) progress_.show(feed_->share_read(), run_.time_s(), run_.state_text());
    if (WallClock::now() < next_publish_) return;
    next_publish_ = WallClock::now() + publish_interval();
    LiveStatus& status = *status_;
    status.any_sample = !run_.empty();
    if (status.any_sample) status.view = run_.view();
    status.rate = rate_of(*feed_, run_);
    RunResult result = result_so_far(status, config_, source_.path);
    if (!result.live) result.live.emplace();
    explainer_.add_newest(result, run_.time_s());
    publish(result, "identifying");
  }

  /// The result as of a file; what cannot be identified is what is known of it.
  RunResult finish() {
    if (run_.empty())
      throw RunError{fmt::format("{}: holds no complete sample: {}", source_.path,
                                 feed_->explain_emptiness(run_.frames()))};
    RunResult result = run_.finish(rate_of(*feed_, run_), source_.path);
    explainer_.conclude(result);
    publish(result, "ended");
    return result;
  }

  void publish(RunResult& result, const char* state) {
    feed_->describe(run_.frames(), result);
    if (!result.live) result.live.emplace();
    result.live->state = state;
    static_cast<void>(alarms_.look(result));
    result.watched = alarms_.states();
    result.origin = origin_of(config_, inputs_, result.origin.recorded);
    result.origin.written_ns =
        std::chrono::nanoseconds{std::chrono::system_clock::now().time_since_epoch()}.count();
    serving_->turn({state, run_.samples(), 0.0});
    serving_->publish(result, to_json(result));
  }

  const Config& config_;
  const SourceOptions& source_;
  const ReplayOptions& options_;
  StopRequest stop_;
  std::unique_ptr<Serving> serving_;
  std::unique_ptr<SampleFeed> feed_;
  ExplainRun run_;
  LiveExplainer explainer_;
  Alarms alarms_;
  Progress progress_;
  std::vector<InputFile> inputs_;
  std::unique_ptr<LiveStatus> status_{std::make_unique<LiveStatus>()};
  WallClock::time_point start_;
  WallClock::time_point next_publish_;
  double looked_at_s_{0.0};
};

}  // namespace

RunResult replay(const Config& config, const SourceOptions& source, SourceKind kind,
                 const ReplayOptions& options) {
  if (kind == SourceKind::kInterface)
    throw UsageError{
        fmt::format("{}: is an interface, expected a record; identify serves it", source.path)};
  if (kind == SourceKind::kRigRows)
    throw UsageError{
        fmt::format("{}: is a rig's record, expected a truck's accelerations", source.path)};
  return std::make_unique<Replay>(config, source, kind, options)->play();
}

}  // namespace dampline::app
