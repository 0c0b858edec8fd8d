// SPDX-License-Identifier: MIT
#include "app/live/live_explainer.hpp"

#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <utility>

#include "app/explain/explanation_json.hpp"
#include "app/explain/fault_veto.hpp"
#include "app/explain/truck_verdict.hpp"

namespace dampline::app {
namespace {

constexpr std::chrono::milliseconds kSamplePatience{50};
constexpr int kNice = 10;  // the acquisition and the writer come first

}  // namespace

LiveExplainer::LiveExplainer(const Config& config, const EstimatorConfig& core, TruckRun& run)
    : whole_{config},
      config_{explainer_config(config)},
      run_{run},
      every_ticks_{std::llround(kEveryS * core.sample_rate_hz)},
      diagnosis_{std::make_unique<effect::Diagnosis>(core)},
      copy_{std::make_unique<effect::StoreCopy>()},
      explainer_{std::make_unique<effect::Explainer>()} {
  run.watch([this](const Sample& sample, const UpdateResult& result) { take(sample, result); });
}

LiveExplainer::~LiveExplainer() { stop(); }

void LiveExplainer::take(const Sample& sample, const UpdateResult& result) noexcept {
  diagnosis_->update(sample, result);
  const Turn turn = turn_.load(std::memory_order_acquire);
  if (turn == Turn::kWait && sample.tick >= next_tick_) {
    next_tick_ = sample.tick + every_ticks_;
    copy_->start();
    turn_.store(Turn::kCopy, std::memory_order_relaxed);
  } else if (turn == Turn::kCopy && copy_->step(diagnosis_->store())) {
    impulses_ = diagnosis_->impulses();
    grids_ = diagnosis_->grids();
    forbidden_ = faults_forbid_naming(run_.fault_kinds());
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
  out.explanation = explainer_->explain(copy_->store(), impulses_, grids_, config_);
  if (out.explanation.conclusion == effect::Conclusion::kNotReady) return;
  out.withheld = forbidden_;
  if (out.withheld) withhold_effects(out.explanation);
  std::string text = to_json(out);
  const std::lock_guard<std::mutex> lock{mutex_};
  newest_ = std::move(text);
}

std::string LiveExplainer::newest() const {
  const std::lock_guard<std::mutex> lock{mutex_};
  return newest_;
}

std::string LiveExplainer::conclude(const RunResult& identified) {
  diagnosis_->finish();
  Explained out;
  out.identified = identified;
  return judge_sums(whole_, *diagnosis_, *explainer_, out) ? to_json(out) : "";
}

}  // namespace dampline::app
