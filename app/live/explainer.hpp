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
#include "app/live/floor.hpp"
#include "app/live/other_truck.hpp"
#include "dampline/effect/gram_store.hpp"
#include "dampline/effect/judgement.hpp"

namespace dampline::app {

/// The explanation of a live run: a copy of its sums from the acquisition's thread, the judgement
/// of the candidates, held against the floor, in a thread of its own, which may take its time.
class LiveExplainer {
 public:
  /// What happens to a sample that finds the explainer a minute and a half behind.
  enum class Pace : std::uint8_t {
    kOfTheBus,  ///< it goes by: the floor is of what there was room for
    kWaits,     ///< it waits, while the explainer's thread runs: of a replay
  };
  /// Watches `run` from now on, which outlives it. Nothing is allocated per sample.
  LiveExplainer(Config config, ExplainRun& run, Pace pace = Pace::kOfTheBus);
  LiveExplainer(const LiveExplainer&) = delete;
  LiveExplainer& operator=(const LiveExplainer&) = delete;
  ~LiveExplainer();

  void start();
  void stop();
  /// Puts the newest explanation beside a result of that time of the record, whose trust is judged
  /// with it; where there is none yet, nothing. Any thread.
  void add_newest(RunResult& result, double time_s) const;
  /// After stop() and the last sample: the explanation of the whole run, as of a file with the same
  /// samples but for what a closer look at it tells; nothing when the run was too short.
  void conclude(RunResult& result);

 private:
  static constexpr double kEveryS = 6.0;  // between two beginnings
  /// Who works: the acquisition waits, copies the sums and then what else is known, or the judge
  /// has the copies.
  enum class Turn : std::uint8_t { kWait, kCopy, kCircumstances, kJudge };

  void take(const Sample& sample, const UpdateResult& result) noexcept;
  void take_sums(std::int64_t tick) noexcept;
  void hand_on(const Sample& sample) noexcept;
  void judge();
  [[nodiscard]] double rate_hz() const noexcept { return run_.config().estimator.sample_rate_hz; }
  void run();

  Config config_;
  ExplainRun& run_;
  Pace pace_;
  std::int64_t every_ticks_;
  bool still_{false};
  LiveFloor floor_;
  LiveOther other_;
  std::unique_ptr<effect::StoreCopy> copy_;
  std::unique_ptr<Statistics> statistics_;
  effect::ImpulseMeter impulses_;
  effect::Grids grids_;
  VelocityError velocity_;
  effect::Circumstances circumstances_;  // of the copy
  GuardedNoise guarded_;
  double copied_s_{0.0};  // of the record, when the copy was whole
  std::int64_t next_tick_{0};
  std::atomic<Turn> turn_{Turn::kWait};

  // The thread's.
  std::unique_ptr<effect::Explainer> explainer_;
  Needless needless_;
  double needless_rows_{0.0};  // of the sums, when they were last asked anew
  mutable std::mutex mutex_;
  std::optional<Explained> newest_;
  double newest_s_{0.0};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace dampline::app
