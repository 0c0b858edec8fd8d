// SPDX-License-Identifier: MIT
#include "app/live/live_explainer.hpp"

#include <sys/resource.h>

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

LiveExplainer::LiveExplainer(const Config& config, ExplainRun& run)
    : whole_{config},
      config_{explainer_config(config)},
      run_{run},
      every_ticks_{std::llround(kEveryS * rate_hz())},
      copy_{std::make_unique<effect::StoreCopy>()},
      statistics_{std::make_unique<Statistics>()},
      explainer_{std::make_unique<effect::Explainer>()} {
  run.watch([this](const Sample& sample, const UpdateResult&) { take(sample); });
}

LiveExplainer::~LiveExplainer() { stop(); }

void LiveExplainer::take(const Sample& sample) noexcept {
  const effect::Diagnosis& sums = run_.core().effects();
  const Turn turn = turn_.load(std::memory_order_acquire);
  if (turn == Turn::kWait && sample.tick >= next_tick_) {
    next_tick_ = sample.tick + every_ticks_;
    copy_->start();
    turn_.store(Turn::kCopy, std::memory_order_relaxed);
  } else if (turn == Turn::kCopy && copy_->step(sums.store())) {
    impulses_ = sums.impulses();
    grids_ = sums.grids();
    turn_.store(Turn::kCircumstances, std::memory_order_relaxed);
  } else if (turn == Turn::kCircumstances) {
    circumstances_.faults = run_.core().faults();
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
    if (turn_.load(std::memory_order_acquire) == Turn::kJudge) {
      judge();
      turn_.store(Turn::kWait, std::memory_order_release);
    }
    std::this_thread::sleep_for(kSamplePatience);
  }
}

void LiveExplainer::judge() {
  Explained out;
  circumstances_ = effect::circumstances_of(circumstances_.faults,
                                            find_parameter_drift(*statistics_, Estimator::kBlockS));
  TruckView view;
  view.first_tick = run_.first_tick();
  view.faults = circumstances_.faults;
  out.identified.faults = faults_of(view, rate_hz());
  if (circumstances_.drift.found) out.identified.faults.drift = finding_of(circumstances_.drift);
  effect::judge(copy_->store(), impulses_, grids_, config_, circumstances_, *explainer_, out);
  if (out.explanation.conclusion == effect::Conclusion::kNotReady) return;
  const std::lock_guard<std::mutex> lock{mutex_};
  newest_ = std::move(out);
}

namespace {

/// Judged as of a file; the result itself keeps the law that it identified.
void add(Explained found, RunResult& result) {
  RunResult final = result;
  final.faults = std::move(found.identified.faults);
  found.identified = final;
  const Explanation told = conclude(found, final);
  result.evidence.explanation = std::move(final.evidence.explanation);
  result.lacking.clear();
  for (const Step& step : told.steps) result.lacking.push_back(step.effect);
  if (!result.parameters.empty()) judge_trust(nullptr, result);
}

}  // namespace

void LiveExplainer::add_newest(RunResult& result) const {
  Explained found;
  {
    const std::lock_guard<std::mutex> lock{mutex_};
    if (!newest_) return;
    found = *newest_;
  }
  add(std::move(found), result);
}

void LiveExplainer::conclude(RunResult& result) {
  Explained found;
  found.identified = result;
  found.circumstances = run_.circumstances();
  if (judge_sums(whole_, run_.core().effects(), *explainer_, found)) add(std::move(found), result);
}

}  // namespace dampline::app
