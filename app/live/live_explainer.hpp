// SPDX-License-Identifier: MIT
#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "app/config/config.hpp"
#include "app/diagnosis/truck/explain.hpp"
#include "app/identify/truck_run.hpp"
#include "dampline/effect/gram_store.hpp"
#include "dampline/effect/judgement.hpp"

namespace dampline::app {

/// The explanation of a live run: a copy of its sums from the acquisition's thread, the judgement
/// of the candidates in a thread of its own, which may take its time.
class LiveExplainer {
 public:
  /// Watches `run` from now on, which outlives it. Nothing is allocated per sample.
  LiveExplainer(const Config& config, ExplainRun& run);
  LiveExplainer(const LiveExplainer&) = delete;
  LiveExplainer& operator=(const LiveExplainer&) = delete;
  ~LiveExplainer();

  void start();
  void stop();
  /// Puts the newest explanation beside a result, whose trust is judged with it; where there is
  /// none yet, nothing. Any thread.
  void add_newest(RunResult& result) const;
  /// After stop() and the last sample: the explanation of the whole run, as of a file with the same
  /// samples that can be read only once; nothing when the run was too short.
  void conclude(RunResult& result);

 private:
  static constexpr double kEveryS = 8.0;  // between two beginnings
  /// Who works: the acquisition waits, copies the sums and then what else is known, or the judge
  /// has the copies.
  enum class Turn : std::uint8_t { kWait, kCopy, kCircumstances, kJudge };

  void take(const Sample& sample) noexcept;
  void judge();
  [[nodiscard]] double rate_hz() const noexcept { return run_.config().estimator.sample_rate_hz; }
  void run();

  Config whole_;
  effect::ExplainerConfig config_;
  ExplainRun& run_;
  std::int64_t every_ticks_;
  std::unique_ptr<effect::StoreCopy> copy_;
  std::unique_ptr<Statistics> statistics_;
  effect::ImpulseMeter impulses_;
  effect::Grids grids_;
  effect::Circumstances circumstances_;  // of the copy
  std::int64_t next_tick_{0};
  std::atomic<Turn> turn_{Turn::kWait};

  std::unique_ptr<effect::Explainer> explainer_;
  mutable std::mutex mutex_;
  std::optional<Explained> newest_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace dampline::app
