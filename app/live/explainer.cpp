// SPDX-License-Identifier: MIT
#include "app/live/explainer.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "app/diagnosis/truck/explanation.hpp"
#include "app/diagnosis/truck/verdict.hpp"

namespace dampline::app {
namespace {

constexpr std::chrono::milliseconds kSamplePatience{50};
constexpr int kNice = 10;  // the acquisition and the writer come first

}  // namespace

LiveExplainer::LiveExplainer(Config config, ExplainRun& run, Pace pace)
    : config_{std::move(config)},
      run_{run},
      pace_{pace},
      every_ticks_{std::llround(kEveryS * rate_hz())},
      floor_{run.config().estimator},
      other_{run.config()},
      copy_{std::make_unique<effect::StoreCopy>()},
      statistics_{std::make_unique<Statistics>()},
      explainer_{std::make_unique<effect::Explainer>()} {
  run.watch([this](const Sample& sample, const UpdateResult& result) { take(sample, result); });
}

LiveExplainer::~LiveExplainer() { stop(); }

void LiveExplainer::take(const Sample& sample, const UpdateResult& result) noexcept {
  if (result.has_motion) still_ = result.motion.still;
  if (!still_) hand_on(sample);
  take_sums(sample.tick);
}

void LiveExplainer::hand_on(const Sample& sample) noexcept {
  while (!floor_.take(sample)) {
    if (pace_ == Pace::kOfTheBus || stop_.load(std::memory_order_acquire)) return;
    std::this_thread::sleep_for(kSamplePatience);
  }
}

void LiveExplainer::take_sums(std::int64_t tick) noexcept {
  const effect::Diagnosis& sums = run_.core().effects();
  const Turn turn = turn_.load(std::memory_order_acquire);
  if (turn == Turn::kWait && tick >= next_tick_) {
    next_tick_ = tick + every_ticks_;
    copy_->start();
    turn_.store(Turn::kCopy, std::memory_order_relaxed);
  } else if (turn == Turn::kCopy && copy_->step(sums.store())) {
    impulses_ = sums.impulses();
    grids_ = sums.grids();
    velocity_ = sums.velocity_error();
    copied_s_ = run_.time_s();
    turn_.store(Turn::kCircumstances, std::memory_order_relaxed);
  } else if (turn == Turn::kCircumstances) {
    circumstances_.faults = run_.core().faults();
    guarded_ = guarded_noise(run_.core());
    run_.core().statistics(*statistics_);
    turn_.store(Turn::kJudge, std::memory_order_release);
  }
}

void LiveExplainer::start() {
  thread_ = std::thread{[this] { run(); }};
}

void LiveExplainer::stop() {
  stop_.store(true, std::memory_order_release);
  if (thread_.joinable()) thread_.join();
}

void LiveExplainer::run() {
  static_cast<void>(::setpriority(PRIO_PROCESS, 0, kNice));  // of this thread
  while (!stop_.load(std::memory_order_acquire)) {
    floor_.follow();
    if (turn_.load(std::memory_order_acquire) == Turn::kJudge) {
      judge();
      turn_.store(Turn::kWait, std::memory_order_release);
    }
    std::this_thread::sleep_for(kSamplePatience);
  }
  floor_.follow();
}

void LiveExplainer::judge() {
  floor_.follow();                  // what the copy is made of has come by now
  constexpr double kAskAnew = 2.0;  // when there are so many times the rows
  Explained out;
  out.circumstances = effect::circumstances_of(
      circumstances_.faults, find_parameter_drift(*statistics_, Estimator::kBlockS));
  TruckView view;
  view.first_tick = run_.first_tick();
  view.faults = out.circumstances.faults;
  out.identified.faults = faults_of(view, rate_hz());
  if (out.circumstances.drift.found)
    out.identified.faults.drift = finding_of(out.circumstances.drift);
  if (copy_->store().rows() > kAskAnew * needless_rows_) {
    needless_ = {};
    needless_rows_ = copy_->store().rows();
  }
  out.needless = needless_;
  if (!judge_live({copy_->store(), impulses_, grids_, velocity_}, {config_, guarded_}, floor_,
                  *explainer_, out))
    return;
  needless_ = out.needless;
  take_misplaced(view, rate_hz(), out);
  const double of_s = other_.look({config_, guarded_}, floor_, copied_s_, *explainer_, out);
  const std::lock_guard<std::mutex> lock{mutex_};
  newest_ = std::move(out);
  newest_s_ = of_s;
}

namespace {

/// Faults that only an explanation finds.
void join(const DataFaults& found, DataFaults& out) {
  for (const FaultFinding& fault : found.list) {
    const bool known = std::any_of(out.list.begin(), out.list.end(), [&](const auto& other) {
      return other.name == fault.name && other.channel == fault.channel;
    });
    if (!known) out.list.push_back(fault);
  }
  out.lasting = out.lasting || found.lasting;
}

/// Concluded as of a file; the result itself keeps the law that it identified.
void add(Explained found, RunResult& result) {
  RunResult final = result;
  final.faults = std::move(found.identified.faults);
  found.identified = final;
  const Explanation told = conclude(found, final);
  result.evidence.explanation = std::move(final.evidence.explanation);
  join(final.faults, result.faults);
  result.lacking.clear();
  for (const Step& step : told.steps) result.lacking.push_back(step.effect);
  if (!result.parameters.empty()) judge_trust(nullptr, result);
}

}  // namespace

void LiveExplainer::add_newest(RunResult& result, double time_s) const {
  Explained found;
  double age_s = 0.0;
  {
    const std::lock_guard<std::mutex> lock{mutex_};
    if (!newest_) return;
    found = *newest_;
    age_s = std::max(time_s - newest_s_, 0.0);
  }
  add(std::move(found), result);
  if (result.live) result.live->explanation_age_s = age_s;
}

void LiveExplainer::conclude(RunResult& result) {
  Explained found;
  found.identified = result;
  found.circumstances = run_.circumstances();
  guarded_ = guarded_noise(run_.core());
  floor_.follow();
  floor_.forget();
  const LiveKnown known{config_, guarded_};
  if (!judge_live(run_.core().effects().sums(), known, floor_, *explainer_, found)) return;
  take_misplaced(run_.view(), rate_hz(), found);
  other_.forget();
  other_.look(known, floor_, run_.time_s(), *explainer_, found);
  add(std::move(found), result);
}

}  // namespace dampline::app
